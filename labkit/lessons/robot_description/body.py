"""Exercise: a description of a robot that meets a drawing."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from labkit.descriptions.forward_kinematics import Transform, link_transforms
from labkit.descriptions.links_and_joints import (
    Box,
    Cylinder,
    Description,
    Geometry,
    Joint,
    Link,
    Sphere,
    Visual,
)
from labkit.errors import nearest
from labkit.exercises import Exercise, Fail, Mistake, words_of
from labkit.exercises.clauses import Evidence, GraphClause
from labkit.exercises.figures import figure
from labkit.lessons.frames.places import metres
from labkit.lessons.robot_description.heard import (
    SAME_M,
    SAME_RAD,
    TOPIC,
    Describes,
    described,
)
from labkit.transforms.rotations import Vector, matrix, rotated

__all__ = ['exercise']

WORDS = words_of(__file__)

ROBOT, BASE = 'cart', 'base_link'


@dataclass(frozen=True)
class _Part:
    """A link of the drawing, images/15_cart.svg.

    Attributes:
        shape: What it looks like. A cylinder lies along y.
        centre: The middle of that, in base_link, m.
        type: The type of the joint that holds it, '' for the base.
    """

    shape: Geometry
    centre: Vector
    type: str = ''

    @property
    def place(self) -> Vector:
        """Where its frame is, in base_link, m."""
        return self.centre if self.type else (0.0, 0.0, 0.0)


WHEEL = Cylinder(0.05, 0.02)
PARTS = {
    BASE: _Part(Box((0.24, 0.16, 0.06)), (0.04, 0.0, 0.02)),
    'left_wheel': _Part(WHEEL, (0.0, 0.09, 0.0), 'continuous'),
    'right_wheel': _Part(WHEEL, (0.0, -0.09, 0.0), 'continuous'),
    'caster': _Part(Sphere(0.02), (0.14, 0.0, -0.03), 'fixed'),
}
AHEAD: Vector = (0.0, 1.0, 0.0)

MISSING = WORDS.mistake('body/missing')
MISSPELT = WORDS.mistake('body/misspelt')
SWAPPED = WORDS.mistake('body/swapped')
PARENT = WORDS.mistake('body/parent')
STIFF = WORDS.mistake('body/stiff')
LOOSE = WORDS.mistake('body/loose')
BACKWARDS = WORDS.mistake('body/backwards')
AXIS = WORDS.mistake('body/axis')
SHAPE = WORDS.mistake('body/shape')
DIAMETER = WORDS.mistake('body/diameter')
HALF = WORDS.mistake('body/half')
UNITS = WORDS.mistake('body/units')
TURNED_BOX = WORDS.mistake('body/turned-box')
SIZE = WORDS.mistake('body/size')
SIDES = WORDS.mistake('body/sides')
ON_VISUAL = WORDS.mistake('body/on-visual')
TWICE = WORDS.mistake('body/twice')
CENTRE = WORDS.mistake('body/centre')
PLACE = WORDS.mistake('body/place')
DEGREES = WORDS.mistake('body/degrees')
LYING = WORDS.mistake('body/lying')


@dataclass(frozen=True)
class _Tree(GraphClause):
    """The links are there, and joints hold them as they should."""

    text = WORDS.of(base=BASE).clause('tree')
    own_life = True

    def judge(self, evidence: Evidence) -> str:
        robot = described(evidence, ROBOT)
        expected = f'links {", ".join(PARTS)}'
        missing = next((name for name in PARTS if name not in robot.links), '')
        if missing:
            others = [name for name in robot.links if name not in PARTS]
            meant = nearest(missing, others)
            mistake = MISSPELT.of(link=missing) if meant else MISSING.of(link=missing)
            raise Fail(expected, f'links {", ".join(robot.links)}', mistake)
        if robot.root != BASE:
            held = robot.holder[BASE]
            seen = f'a joint with parent {held.parent} and child {BASE}'
            raise Fail(f'{BASE} holds all others', seen, SWAPPED)
        places = link_transforms(robot)
        for name, part in PARTS.items():
            if part.type:
                self._judge_joint(robot.holder[name], part, places[name])
        return 'Both wheels turn forwards, and the caster is fixed.'

    def _judge_joint(self, joint: Joint, part: _Part, place: Transform) -> None:
        if joint.parent != BASE:
            seen = f'{joint.name} from {joint.parent} to {joint.child}'
            raise Fail(f'a joint from {BASE} to {joint.child}', seen, PARENT)
        if joint.type != part.type:
            mistake = LOOSE if part.type == 'fixed' else STIFF
            raise Fail(f'{joint.name} of type {part.type}', f'type {joint.type}', mistake)
        if part.type == 'fixed':
            return
        axis = rotated(place.rotation, joint.axis)
        dot = axis[1] / math.hypot(*axis)
        if dot < math.cos(SAME_RAD):
            seen = f'{_three(axis)} in {BASE}'
            mistake = BACKWARDS if dot < -math.cos(SAME_RAD) else AXIS
            raise Fail(f'{joint.name} turns about y: 0, 1, 0 in {BASE}', seen, mistake)


@dataclass(frozen=True)
class _Drawn(GraphClause):
    """Shapes, sizes and places are those of the drawing."""

    text = WORDS.clause('drawn')
    own_life = True

    def judge(self, evidence: Evidence) -> str:
        robot = described(evidence, ROBOT)
        places = link_transforms(robot)
        for name, part in PARTS.items():
            link = robot.links[name]
            visual = next((v for v in link.visuals if type(v.geometry) is type(part.shape)), None)
            if visual is None:
                kinds = ', '.join(_kind(v.geometry) for v in link.visuals) or 'nothing'
                raise Fail(f'{name}: a {_kind(part.shape)}', f'{name}: {kinds}', SHAPE)
            seen = places[name] * Transform(visual.origin.xyz, visual.origin.turn)
            self._judge_angles(robot, link, visual)
            self._judge_turn(name, part, seen)
            self._judge_size(name, part.shape, visual.geometry, seen)
            self._judge_place(name, part, places[name].translation, seen.translation)
        return 'All sizes and places are those of the drawing.'

    def _judge_angles(self, robot: Description, link: Link, visual: Visual) -> None:
        joint = robot.holder.get(link.name)
        angles = [*visual.origin.rpy, *(joint.origin.rpy if joint else ())]
        wide = max(angles, key=abs)
        if abs(wide) > math.tau + SAME_RAD:
            seen = f'{figure(wide)} in rpy of {link.name}'
            raise Fail(f'{link.name}: angles in radians', seen, DEGREES)

    def _judge_turn(self, name: str, part: _Part, seen: Transform) -> None:
        if not isinstance(part.shape, Cylinder):
            return
        along = rotated(seen.rotation, (0.0, 0.0, 1.0))
        if abs(along[1]) < math.cos(SAME_RAD):
            raise Fail(f'{name} lies along y, the axle', f'along {_three(along)}', LYING)

    def _judge_size(self, name: str, wanted: Geometry, found: Geometry, seen: Transform) -> None:
        want, have = dict(_sizes(wanted, Transform())), dict(_sizes(found, seen))
        if all(_near(have[key], size) for key, size in want.items()):
            return
        expected, words = (
            ', '.join(f'{k} = {figure(v)} m' for k, v in s.items()) for s in (want, have)
        )
        raise Fail(f'{name}: {expected}', f'{name}: {words}', _why_size(want, have))

    def _judge_place(self, name: str, part: _Part, frame: Vector, centre: Vector) -> None:
        if _same(frame, part.place) and _same(centre, part.centre):
            return
        what, wanted, have = f'the frame of {name}', part.place, frame
        if _same(frame, part.place):
            what, wanted, have = f'the middle of {name}', part.centre, centre
        x, y, z = wanted
        raise Fail(
            f'{what}: {metres(wanted)}',
            f'{what}: {metres(have)}',
            _why_place(part, frame, centre)
            or (
                SIDES if _same(have, (x, -y, z)) else UNITS if _is_scaled(have, wanted) else PLACE
            ),
        )


def _why_place(part: _Part, frame: Vector, centre: Vector) -> Mistake | None:
    """Return the mistake that both places together show."""
    zero: Vector = (0.0, 0.0, 0.0)
    if not part.type:
        return CENTRE if _same(centre, zero) else None
    if _same(frame, zero) and _same(centre, part.centre):
        return ON_VISUAL
    x, y, z = part.centre
    return TWICE if _same(frame, part.place) and _same(centre, (2 * x, 2 * y, 2 * z)) else None


def _why_size(want: dict[str, float], have: dict[str, float]) -> Mistake:
    def scaled(factor: float) -> bool:
        return all(_near(have[key], factor * size) for key, size in want.items())

    if scaled(100.0) or scaled(1000.0):
        return UNITS
    if 'radius' in want and _near(have['radius'], 2 * want['radius']):
        return DIAMETER
    if scaled(0.5) or ('length' in want and _near(have['length'], want['length'] / 2)):
        return HALF
    if 'x' in want and _near(have['x'], want['y']) and _near(have['y'], want['x']):
        return TURNED_BOX
    return SIZE


def _sizes(shape: Geometry, place: Transform) -> Iterator[tuple[str, float]]:
    """Give the sizes of a shape, m; those of a box along the axes of base_link."""
    if isinstance(shape, Box):
        rows = matrix(place.rotation)
        for axis, row in zip('xyz', rows, strict=True):
            yield axis, sum(abs(a) * size for a, size in zip(row, shape.size, strict=True))
    if isinstance(shape, (Cylinder, Sphere)):
        yield 'radius', shape.radius
    if isinstance(shape, Cylinder):
        yield 'length', shape.length


def _near(one: float, other: float) -> bool:
    return abs(one - other) <= SAME_M


def _same(one: Vector, other: Vector) -> bool:
    return math.dist(one, other) <= SAME_M


def _is_scaled(have: Vector, wanted: Vector) -> bool:
    return any(_same(have, (f * wanted[0], f * wanted[1], f * wanted[2])) for f in (100.0, 1000.0))


def _three(vector: Vector) -> str:
    return ', '.join(figure(round(part, 3)) for part in vector)


def _kind(shape: Geometry) -> str:
    return type(shape).__name__.lower()


exercise = Exercise(
    words=WORDS,
    clauses=(Describes(ROBOT), _Tree(), _Drawn()),
    shared=(TOPIC,),
)
