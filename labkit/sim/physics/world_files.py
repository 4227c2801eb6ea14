"""Worlds with physics from files in SDF and MJCF: of both a small part, and a reason for the rest.

What is read: boxes and cylinders that stand upright, planes as the floor, and boxes with equal
edges that move. Sources: sdformat.org/spec; mujoco.readthedocs.io, "XML Reference".
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from labkit.descriptions.forward_kinematics import Transform
from labkit.errors import LabError, quoted
from labkit.files import is_inside, read_limited
from labkit.rosgraph.xml_loading import Element, XmlError, load_xml
from labkit.sim.kinematics import Pose
from labkit.sim.physics.mujoco_world import PhysicsWorld, outline
from labkit.sim.physics.things import Crate
from labkit.sim.world import Post, Wall, World
from labkit.transforms.rotations import from_rpy, matrix, rotated

__all__ = ['read_world']

# Included models that bring nothing but light and the floor.
_FLOOR = ('sun', 'ground_plane')
# How deep models may include each other.
_DEEPEST = 5
# Of an upright thing and of equal edges, this much may be rounding.
_ROUNDING = 1e-3


def read_world(path: str | Path) -> PhysicsWorld:
    """Return the world that a file in SDF or MJCF describes.

    Boxes and cylinders that stand become walls and posts, boxes that move become crates. Models
    that the file includes as `model://NAME` are looked for beside it: NAME/model.sdf.

    Args:
        path: The file.

    Raises:
        LabError: It can't be read, or has what this does not know, with its line.
    """
    path = Path(path)
    reader = _Reader(path.parent)
    root = _load(path)
    if root.tag == 'sdf':
        reader.sdf(root, Transform(), 0)
    elif root.tag == 'mujoco':
        reader.mjcf(root)
    else:
        raise LabError(
            f'A world is in <sdf> or in <mujoco>, and {quoted(path.name)} begins with '
            f'<{root.tag}>.'
        )
    return PhysicsWorld(World(reader.walls, reader.posts), crates=reader.crates)


def _load(path: Path) -> Element:
    try:
        return load_xml(read_limited(path).decode())
    except XmlError as error:
        raise LabError(f'{path.name}, line {error.line}: this is no XML: {error}.') from error
    except (OSError, UnicodeDecodeError) as error:
        raise LabError(f'The world {quoted(str(path))} can not be read: {error}') from error


@dataclass
class _Shape:
    """A shape in the world: where it is, how large, and what it weighs if it moves."""

    at: Element
    kind: str
    size: tuple[float, ...]
    place: Transform
    mass: float | None = None
    friction: float | None = None


@dataclass
class _Reader:
    """Collects what a world consists of."""

    folder: Path
    walls: list[Wall] = field(default_factory=list)
    posts: list[Post] = field(default_factory=list)
    crates: list[Crate] = field(default_factory=list)

    def wrong(self, at: Element, message: str, todo: str = '') -> LabError:
        """Return an error with its line."""
        return LabError(f'Line {at.line}: {message}', todo=todo)

    def add(self, shape: _Shape) -> None:
        """Add a shape to the world."""
        x, y, z = shape.place.translation
        if shape.kind == 'plane':
            if abs(z) > _ROUNDING:
                raise self.wrong(shape.at, f'The floor is at z = 0, and this is at {z:g} m.')
            return
        up = rotated(shape.place.rotation, (0.0, 0.0, 1.0))
        if up[2] < 1 - _ROUNDING:
            raise self.wrong(shape.at, f'A {shape.kind} stands upright here, and this is tilted.')
        rows = matrix(shape.place.rotation)
        yaw = math.atan2(rows[1][0], rows[0][0])
        if shape.kind == 'cylinder' and shape.mass is None:
            self.posts.append(Post(x, y, shape.size[0]))
        elif shape.kind == 'box' and shape.mass is None:
            self.walls += outline(Pose(x, y, yaw), shape.size[0] / 2, shape.size[1] / 2)
        elif shape.kind == 'box' and max(shape.size) - min(shape.size) < _ROUNDING:
            assert shape.mass is not None
            friction = {} if shape.friction is None else {'friction': shape.friction}
            self.crates.append(Crate(x, y, yaw, shape.size[0], shape.mass, **friction))
        else:
            raise self.wrong(
                shape.at,
                f'A {shape.kind} of these sizes can not move here: only boxes with equal edges '
                'can.',
                'Let it stand: <static>true</static> in SDF, no <freejoint/> in MJCF.',
            )

    # -- SDF ------------------------------------------------------------------------------------

    def sdf(self, root: Element, place: Transform, depth: int) -> None:
        """Add what an SDF file has."""
        worlds = root.all('world') or [root]
        for inner in worlds:
            for include in inner.all('include'):
                self._include(include, place, depth)
            for model in inner.all('model'):
                self._model(model, place)

    def _include(self, at: Element, place: Transform, depth: int) -> None:
        uri = at.first('uri')
        name = uri.text.removeprefix('model://') if uri is not None else ''
        if name in _FLOOR:
            return
        path = self.folder / name / 'model.sdf'
        if not name or not is_inside(path, self.folder, follow_links=False):
            raise self.wrong(at, f'An <include> has a <uri> model://NAME, and this has {name!r}.')
        if depth >= _DEEPEST:
            raise self.wrong(at, 'Models include each other too deep.')
        self.sdf(_load(path), place * self._pose(at), depth + 1)

    def _model(self, model: Element, place: Transform) -> None:
        static = model.first('static')
        stands = static is not None and static.text in ('true', '1')
        place = place * self._pose(model)
        links = model.all('link')
        if not stands and len(links) != 1:
            raise self.wrong(
                model,
                f'A model that moves has one link here, and this has {len(links)}.',
                'Robots are made by lab.Turtlebot(physics=True).',
            )
        for link in links:
            inner = place * self._pose(link)
            mass = None if stands else self._mass(link)
            for collision in link.all('collision'):
                self.add(self._collision(collision, inner, mass))

    def _mass(self, link: Element) -> float:
        inertial = link.first('inertial')
        mass = inertial.first('mass') if inertial is not None else None
        return self._numbers(mass, 1)[0] if mass is not None else 1.0

    def _collision(self, at: Element, place: Transform, mass: float | None) -> _Shape:
        geometry = at.first('geometry')
        shape = next(iter(geometry.children), None) if geometry is not None else None
        if shape is None or shape.tag not in ('box', 'cylinder', 'plane'):
            tag = shape.tag if shape is not None else 'nothing'
            raise self.wrong(
                at, f'A shape is a <box>, a <cylinder> or a <plane> here, and this is <{tag}>.'
            )
        size: tuple[float, ...] = ()
        if shape.tag == 'box':
            size = tuple(self._numbers(self._inner(shape, 'size'), 3))
        elif shape.tag == 'cylinder':
            size = tuple(self._numbers(self._inner(shape, 'radius'), 1))
        return _Shape(at, shape.tag, size, place * self._pose(at), mass, self._mu(at))

    def _mu(self, at: Element) -> float | None:
        found: Element | None = at
        for tag in ('surface', 'friction', 'ode', 'mu'):
            found = found.first(tag) if found is not None else None
        return self._numbers(found, 1)[0] if found is not None else None

    def _pose(self, at: Element) -> Transform:
        pose = at.first('pose')
        if pose is None or not pose.text:
            return Transform()
        x, y, z, roll, pitch, yaw = self._numbers(pose, 6)
        return Transform((x, y, z), from_rpy(roll, pitch, yaw))

    def _inner(self, at: Element, tag: str) -> Element:
        found = at.first(tag)
        if found is None:
            raise self.wrong(at, f'<{at.tag}> has no <{tag}>.')
        return found

    def _numbers(self, at: Element, count: int, text: str | None = None) -> list[float]:
        text = at.text if text is None else text
        try:
            found = [float(word) for word in text.split()]
        except ValueError:
            found = []
        if len(found) != count or not all(map(math.isfinite, found)):
            raise self.wrong(at, f'<{at.tag}> has {count} numbers, and this has {quoted(text)}.')
        return found

    # -- MJCF -----------------------------------------------------------------------------------

    def mjcf(self, root: Element) -> None:
        """Add what a file in MJCF has."""
        compiler = root.first('compiler')
        options = compiler.attributes if compiler is not None else {}
        unit: Callable[[float], float] = math.radians
        if options.get('angle') == 'radian':
            unit = float
        if 'eulerseq' in options:
            raise self.wrong(root, 'eulerseq is not known here: angles are about x, y and z.')
        for included in root.all('include'):
            raise self.wrong(included, '<include> is not known here, in MJCF.')
        for body in root.all('worldbody'):
            self._body(body, Transform(), unit)

    def _body(self, body: Element, place: Transform, unit: Callable[[float], float]) -> None:
        moves = bool(body.all('freejoint'))
        for joint in body.all('joint'):
            raise self.wrong(joint, 'A body stands, or has a <freejoint/>; others are not known.')
        for geom in body.all('geom'):
            self.add(self._geom(geom, place, unit, moves))
        for inner in body.all('body'):
            self._body(inner, place * self._mjcf_pose(inner, unit), unit)

    def _geom(
        self, geom: Element, place: Transform, unit: Callable[[float], float], moves: bool
    ) -> _Shape:
        kind = geom.attributes.get('type', 'sphere')
        counts = {'box': 3, 'cylinder': 2, 'plane': 3}
        if kind not in counts:
            raise self.wrong(
                geom, f'A geom is a box, a cylinder or a plane here, and this is a {kind}.'
            )
        half = self._numbers(geom, counts[kind], geom.attributes.get('size', ''))
        size = tuple(2 * each for each in half) if kind == 'box' else tuple(half)
        mass = self._numbers(geom, 1, geom.attributes.get('mass', '1'))[0] if moves else None
        friction = geom.attributes.get('friction', '').split()[:1]
        return _Shape(
            geom,
            kind,
            size,
            place * self._mjcf_pose(geom, unit),
            mass,
            self._numbers(geom, 1, friction[0])[0] if friction else None,
        )

    def _mjcf_pose(self, at: Element, unit: Callable[[float], float]) -> Transform:
        x, y, z = self._numbers(at, 3, at.attributes.get('pos', '0 0 0'))
        for name in ('axisangle', 'xyaxes', 'zaxis', 'fromto'):
            if name in at.attributes:
                raise self.wrong(at, f'{name} is not known here: turns are euler or quat.')
        if 'quat' in at.attributes:
            w, a, b, c = self._numbers(at, 4, at.attributes['quat'])
            return Transform((x, y, z), (a, b, c, w))
        angles = self._numbers(at, 3, at.attributes.get('euler', '0 0 0'))
        # One after another about the body's own axes, which is the other way round about fixed
        # ones; upright things are turned about z alone.
        roll, pitch, yaw = map(unit, angles)
        turn = Transform(rotation=from_rpy(roll, 0.0, 0.0))
        turn = turn * Transform(rotation=from_rpy(0.0, pitch, 0.0))
        turn = turn * Transform(rotation=from_rpy(0.0, 0.0, yaw))
        return Transform((x, y, z), turn.rotation)
