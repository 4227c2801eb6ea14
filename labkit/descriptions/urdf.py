"""Robots as URDF describes them: a text becomes a description, or sentences on what is wrong.

What is an error, and what is taken though nobody can have meant it, is as in the parser that ROS
uses: ros/urdfdom, urdf_parser/src (model.cpp, link.cpp, joint.cpp, pose.cpp). It ends at the first
error; this one finds all.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from labkit.descriptions.links_and_joints import (
    TYPES,
    Box,
    Collision,
    Cylinder,
    Description,
    Dynamics,
    Geometry,
    Inertial,
    Joint,
    Limits,
    Link,
    Material,
    Mesh,
    Mimic,
    Origin,
    Sphere,
    Visual,
)
from labkit.descriptions.urdf_checks import doubts
from labkit.descriptions.urdf_problems import Problem
from labkit.errors import LabError, did_you_mean, first_few, nearest, quoted
from labkit.rosgraph.xml_loading import Element, XmlError, load_xml

__all__ = ['DescriptionError', 'Reading', 'examine', 'read']

T = TypeVar('T')
# What xacro replaces: ${radius}, $(find package).
_XACRO = re.compile(r'\$[{(]')
SHAPES = ('box', 'cylinder', 'sphere', 'mesh')
# Tags that this reads, by the tag in which they stand. All others are for other programs.
KNOWN = {
    'robot': ('link', 'joint', 'material'),
    'link': ('visual', 'collision', 'inertial'),
    'visual': ('geometry', 'origin', 'material'),
    'collision': ('geometry', 'origin'),
    'inertial': ('mass', 'inertia', 'origin'),
    'joint': ('parent', 'child', 'origin', 'axis', 'limit', 'mimic', 'dynamics'),
}


class DescriptionError(LabError):
    """Report a text that describes no robot.

    Attributes:
        problems: All that is wrong with it.
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        first, *others = self.problems
        todo = first.todo
        if others:
            lines = '\n'.join(f'- {other}' for other in others[:9])
            todo += f'\nBesides:\n{lines}' + '\n- and more' * (len(others) > 9)
        super().__init__(str(first), todo=todo.strip())


@dataclass(frozen=True)
class Reading:
    """What a text says.

    Attributes:
        description: The robot, None if there are errors.
        problems: What is wrong, and what nobody can have meant, errors first.
    """

    description: Description | None
    problems: tuple[Problem, ...] = ()

    @property
    def errors(self) -> tuple[Problem, ...]:
        """The problems because of which there is no robot."""
        return tuple(problem for problem in self.problems if problem.is_error)


def read(text: str, *, folder: Path | None = None) -> Description:
    """Return the robot that a text in URDF describes.

    Args:
        text: The text; one in xacro is to be expanded before.
        folder: Where it lies, for meshes with paths relative to that.

    Raises:
        DescriptionError: It describes none; says all that is wrong.
    """
    found = examine(text, folder=folder)
    if found.description is None:
        raise DescriptionError(found.errors)
    return found.description


def examine(text: str, *, folder: Path | None = None) -> Reading:
    """Return the robot that a text in URDF describes, and all that is wrong with it."""
    try:
        root = load_xml(text)
    except XmlError as error:
        todo = (
            'Each tag ends with /> or has an end tag, and in a value & is written &amp;, < is '
            'written &lt;.'
        )
        return Reading(None, (Problem(f'This is no XML: {error}.', todo, error.line, True),))
    reader = _Reader()
    found = reader.robot(root)
    if found is None or reader.has_errors:
        return Reading(None, tuple(reader.sorted()))
    reader.problems += doubts(found, folder)
    return Reading(found, tuple(reader.sorted()))


class _Wrong(Exception):
    """Leave an element that can't be read; its problem has been noted."""


class _Reader:
    """Reads elements, and notes what is wrong with them."""

    def __init__(self) -> None:
        self.problems: list[Problem] = []
        self._materials: dict[str, Material] = {}
        self._has_said_xacro = False

    @property
    def has_errors(self) -> bool:
        return any(problem.is_error for problem in self.problems)

    def sorted(self) -> list[Problem]:
        """Return the problems, errors first, then by line."""
        return sorted(self.problems, key=lambda problem: (not problem.is_error, problem.line))

    def wrong(self, at: Element, message: str, todo: str = '') -> _Wrong:
        """Note an error."""
        self.problems.append(Problem(message, todo, at.line, True))
        return _Wrong()

    def doubt(self, at: Element, message: str, todo: str = '') -> None:
        """Note what nobody can have meant."""
        self.problems.append(Problem(message, todo, at.line, False))

    def robot(self, root: Element) -> Description | None:
        if root.tag != 'robot':
            todo = 'The first tag is <robot name="my_robot">, and all others stand in it.'
            if root.tag == 'sdf':
                todo = 'SDF describes worlds and robots for Gazebo; ROS takes URDF. ' + todo
            self.wrong(
                root, f'A description begins with <robot>, and this with <{root.tag}>.', todo
            )
            return None
        if 'name' not in root.attributes:
            self.wrong(root, '<robot> has no name.', '<robot name="my_robot">')
        if root.attributes.get('version', '1.0') not in ('1.0', '1'):
            version = quoted(root.attributes['version'])
            self.wrong(root, f'<robot> has version {version}, and only "1.0" is known.')
        self._check_tags(root)
        # First, since a link may name a material that stands below it.
        for element in root.all('material'):
            self._try(self._global_material, element)
        links = self._named(root.all('link'), self._link)
        joints = self._named(root.all('joint'), self._joint)
        if not links and not self.has_errors:
            self.wrong(root, '<robot> has no <link>, and needs one at least.')
        found = Description(root.attributes.get('name', ''), links, joints, self._materials)
        if not self.has_errors:
            self._check_tree(root, found)
        return found

    # -- links ----------------------------------------------------------------------------------

    def _link(self, element: Element) -> Link:
        name = self._text(element, 'name')
        where = f'link {quoted(name)}'
        inertial = element.first('inertial')
        return Link(
            name,
            tuple(self._kept(self._visual, element.all('visual'), where)),
            tuple(self._kept(self._collision, element.all('collision'), where)),
            None if inertial is None else self._inertial(inertial, where),
            element.line,
        )

    def _visual(self, element: Element, where: str) -> Visual:
        self._check_tags(element)
        material = element.first('material')
        return Visual(
            self._geometry(element, where),
            self._origin(element, where),
            Material() if material is None else self._material(material, where),
            element.attributes.get('name', ''),
        )

    def _collision(self, element: Element, where: str) -> Collision:
        self._check_tags(element)
        name = element.attributes.get('name', '')
        return Collision(self._geometry(element, where), self._origin(element, where), name)

    def _geometry(self, element: Element, where: str) -> Geometry:
        geometry = element.first('geometry')
        shape = next(iter(geometry.children), None) if geometry is not None else None
        if geometry is None or shape is None:
            raise self.wrong(
                geometry or element,
                f'A <{element.tag}> of {where} has no shape.',
                'Its shape stands in a <geometry>: <geometry><box size="0.1 0.1 0.1"/></geometry>',
            )
        if shape.tag == 'box':
            return Box(self._vector(shape, 'size', where))
        if shape.tag == 'cylinder':
            radius = self._number(shape, 'radius', where)
            return Cylinder(radius, self._number(shape, 'length', where))
        if shape.tag == 'sphere':
            return Sphere(self._number(shape, 'radius', where))
        if shape.tag == 'mesh':
            scale = (1.0, 1.0, 1.0)
            if 'scale' in shape.attributes:
                scale = self._vector(shape, 'scale', where)
            return Mesh(self._text(shape, 'filename', where), scale)
        raise self.wrong(
            shape,
            f'{where} has the shape <{shape.tag}>, and URDF has <box>, <cylinder>, <sphere> and '
            '<mesh>.',
            did_you_mean(shape.tag, SHAPES, 'A shape of other forms is a <mesh>, from a file.'),
        )

    def _origin(self, element: Element, where: str) -> Origin:
        origin = element.first('origin')
        if origin is None:
            return Origin()
        for name in origin.attributes.keys() - {'xyz', 'rpy'}:
            self.doubt(
                origin,
                f'An <origin> of {where} has {quoted(name)}, which ROS does not read.',
                did_you_mean(name, ('xyz', 'rpy'), 'It has xyz, in m, and rpy, in rad.'),
            )
        xyz, rpy = (
            self._vector(origin, name, where) if name in origin.attributes else (0.0, 0.0, 0.0)
            for name in ('xyz', 'rpy')
        )
        return Origin(xyz, rpy)

    def _inertial(self, element: Element, where: str) -> Inertial:
        self._check_tags(element)
        mass, inertia = element.first('mass'), element.first('inertia')
        if mass is None:
            raise self.wrong(
                element, f'The <inertial> of {where} has no mass.', '<mass value="0.1"/>, in kg.'
            )
        names = ('ixx', 'ixy', 'ixz', 'iyy', 'iyz', 'izz')
        if inertia is None:
            written = ' '.join(f'{name}="0.0"' for name in names)
            raise self.wrong(
                element,
                f'The <inertial> of {where} has no inertia.',
                f'<inertia {written}/>, in kg m², with numbers for ixx, iyy and izz.',
            )
        value = self._number(mass, 'value', where)
        a, b, c, d, e, f = (self._number(inertia, name, where) for name in names)
        return Inertial(value, (a, b, c, d, e, f), self._origin(element, where))

    # -- materials ------------------------------------------------------------------------------

    def _global_material(self, element: Element) -> None:
        name = self._text(element, 'name')
        if name in self._materials:
            raise self.wrong(
                element, f'There are two materials {quoted(name)}.', 'Give one another name.'
            )
        found = self._own_material(element, name)
        if found is None:
            self.doubt(
                element,
                f'The material {quoted(name)} has neither a colour nor a texture.',
                '<color rgba="1 0 0 1"/> is red: red, green, blue and how opaque, from 0 to 1.',
            )
        self._materials[name] = found or Material(name)

    def _material(self, element: Element, where: str) -> Material:
        name = self._text(element, 'name', where)
        # One with a name that is known is that one, whatever stands here.
        found = self._materials.get(name) or self._own_material(element, name)
        if found is None:
            self.doubt(
                element,
                f'{where} has the material {quoted(name)}, and there is none of that name.',
                did_you_mean(
                    name,
                    self._materials,
                    f'Give it a colour, here or in <robot>: <material name="{name}"><color '
                    'rgba="1 0 0 1"/></material>',
                ),
            )
            return Material(name)
        if name:
            self._materials.setdefault(name, found)
        return found

    def _own_material(self, element: Element, name: str) -> Material | None:
        color, texture = element.first('color'), element.first('texture')
        picture = texture.attributes.get('filename', '') if texture is not None else ''
        if color is not None and 'rgba' in color.attributes:
            where = f'material {quoted(name)}'
            r, g, b, a = self._numbers(color, 'rgba', 4, where)
            if not all(0 <= number <= 1 for number in (r, g, b, a)):
                self.doubt(
                    color,
                    f'The colour of {where} is {quoted(color.attributes["rgba"])}, and its '
                    'numbers are from 0 to 1.',
                    'Divide numbers up to 255 by 255.' if max(r, g, b) > 1 else '',
                )
            return Material(name, (r, g, b, a), picture)
        return Material(name, texture=picture) if picture else None

    # -- joints ---------------------------------------------------------------------------------

    def _joint(self, element: Element) -> Joint:
        name = self._text(element, 'name')
        where = f'joint {quoted(name)}'
        kind = self._text(element, 'type', where)
        if kind not in TYPES:
            raise self.wrong(
                element,
                f'{where} has the type {quoted(kind)}, and the types are {", ".join(TYPES)}.',
                did_you_mean(kind, TYPES, 'A wheel is continuous, an arm that has ends revolute.'),
            )
        parent, child = (self._end(element, tag, where) for tag in ('parent', 'child'))
        return Joint(
            name,
            kind,
            parent,
            child,
            self._origin(element, where),
            self._axis(element, kind, where),
            self._limits(element, kind, where),
            self._mimic(element, where),
            self._dynamics(element, where),
            element.line,
        )

    def _end(self, element: Element, tag: str, where: str) -> str:
        end = element.first(tag)
        if end is None or 'link' not in end.attributes:
            raise self.wrong(
                end or element, f'{where} has no {tag}.', f'<{tag} link="NAME_OF_A_LINK"/>'
            )
        return end.attributes['link']

    def _axis(self, element: Element, kind: str, where: str) -> tuple[float, float, float]:
        axis = element.first('axis')
        if kind in ('fixed', 'floating') or axis is None or 'xyz' not in axis.attributes:
            return 1.0, 0.0, 0.0
        x, y, z = self._vector(axis, 'xyz', where)
        length = math.hypot(x, y, z)
        if length == 0:
            raise self.wrong(
                axis,
                f'The axis of {where} is {quoted(axis.attributes["xyz"])}, which has no length.',
                '<axis xyz="0 0 1"/> is the z axis of the joint.',
            )
        if abs(length - 1) > 1e-3:
            self.doubt(
                axis,
                f'The axis of {where} has the length {length:.4g}, and 1 is expected. Some '
                'programs make it 1, as this one, and some do not.',
            )
        return x / length, y / length, z / length

    def _limits(self, element: Element, kind: str, where: str) -> Limits | None:
        limit = element.first('limit')
        if limit is None:
            if kind in ('revolute', 'prismatic'):
                more = ' A wheel, which turns without end, is of type continuous.'
                raise self.wrong(
                    element,
                    f'{where} is {kind} and has no <limit>.',
                    '<limit lower="-1.57" upper="1.57" effort="1" velocity="1"/>'
                    + more * (kind == 'revolute'),
                )
            return None
        names = ('lower', 'upper')
        lower, upper = (
            self._number(limit, name, where) if name in limit.attributes else 0.0 for name in names
        )
        effort, velocity = (self._number(limit, name, where) for name in ('effort', 'velocity'))
        return Limits(lower, upper, effort, velocity)

    def _mimic(self, element: Element, where: str) -> Mimic | None:
        mimic = element.first('mimic')
        if mimic is None:
            return None
        numbers = {
            name: self._number(mimic, name, where)
            for name in ('multiplier', 'offset')
            if name in mimic.attributes
        }
        return Mimic(self._text(mimic, 'joint', where), **numbers)

    def _dynamics(self, element: Element, where: str) -> Dynamics:
        dynamics = element.first('dynamics')
        if dynamics is None:
            return Dynamics()
        names = [name for name in ('damping', 'friction') if name in dynamics.attributes]
        if not names:
            raise self.wrong(dynamics, f'<dynamics> of {where} has neither damping nor friction.')
        return Dynamics(**{name: self._number(dynamics, name, where) for name in names})

    # -- the tree -------------------------------------------------------------------------------

    def _check_tree(self, root: Element, found: Description) -> None:
        at = {(each.tag, each.attributes.get('name')): each for each in root.children}
        holders: dict[str, Joint] = {}
        for joint in found.joints.values():
            here = at['joint', joint.name]
            for tag, name in (('parent', joint.parent), ('child', joint.child)):
                if name not in found.links:
                    self.wrong(
                        here,
                        f'The {tag} of joint {quoted(joint.name)} is the link {quoted(name)}, and '
                        'there is none of that name.',
                        did_you_mean(name, found.links, f'Write it: <link name="{name}"/>'),
                    )
            other = holders.setdefault(joint.child, joint)
            if other is not joint:
                self.wrong(
                    here,
                    f'The link {quoted(joint.child)} is the child of two joints, '
                    f'{quoted(other.name)} and {quoted(joint.name)}; in a tree '
                    'each link has one parent.',
                    'Take another link as the child of one of them.',
                )
            self._check_mimic(here, joint, found)
        if self.has_errors:
            return
        roots = [name for name in found.links if name not in holders]
        loop = _loop(holders)
        if loop:
            names = ' -> '.join(loop)
            self.wrong(
                at['joint', holders[loop[0]].name],
                f'These links hold each other in a loop: {names}.',
                'Each link is held by one joint, and the first of them by none. A loop of a real '
                'mechanism is cut at one joint.',
            )
        elif len(roots) > 1:
            biggest, *others = (name for name, _ in _held(found).most_common())
            self.wrong(
                at['link', others[0]],
                f'{len(roots)} links have no parent: {first_few([quoted(r) for r in roots])}. A '
                'robot is one tree, so there is one.',
                f'Hold it by a joint: <joint name="{others[0]}_joint" type="fixed"><parent '
                f'link="{biggest}"/><child link="{others[0]}"/></joint>',
            )

    def _check_mimic(self, here: Element, joint: Joint, found: Description) -> None:
        if joint.mimic is None:
            return
        leader = joint.mimic.joint
        if leader not in found.joints:
            self.wrong(
                here,
                f'joint {quoted(joint.name)} mimics {quoted(leader)}, and there is no joint of '
                'that name.',
                did_you_mean(leader, found.joints),
            )
            return
        seen: set[str] = set()
        while leader in found.joints and leader not in seen:
            if leader == joint.name:
                self.wrong(here, f'joint {quoted(joint.name)} mimics itself.')
                return
            seen.add(leader)
            mimic = found.joints[leader].mimic
            leader = mimic.joint if mimic is not None else ''

    # -- values ---------------------------------------------------------------------------------

    def _text(self, element: Element, name: str, where: str = '') -> str:
        value = element.attributes.get(name)
        if value is None:
            of = f' of {where}' if where else ''
            raise self.wrong(element, f'<{element.tag}>{of} has no {name}, and needs one.')
        if name == 'name' and _XACRO.search(value):
            self._say_xacro(element, f'The name {quoted(value)}')
        return value

    def _say_xacro(self, element: Element, what: str) -> None:
        """Doubt what xacro has left, once: where it is, there is more of it."""
        if not self._has_said_xacro:
            self._has_said_xacro = True
            message = f'{what} is for xacro, which has not been run.'
            self.doubt(element, message, 'xacro FILE prints the URDF.')

    def _number(self, element: Element, name: str, where: str) -> float:
        return self._numbers(element, name, 1, where)[0]

    def _vector(self, element: Element, name: str, where: str) -> tuple[float, float, float]:
        x, y, z = self._numbers(element, name, 3, where)
        return x, y, z

    def _numbers(self, element: Element, name: str, count: int, where: str) -> list[float]:
        text = self._text(element, name, where)
        words = text.split()
        try:
            # Digits alone: float() takes 1_000 and infinity, too.
            found = [float(word) for word in words if re.fullmatch(r'[-+.\deE]+', word)]
        except ValueError:
            found = []
        finite = all(map(math.isfinite, found))
        if len(found) == len(words) == count and finite:
            return found
        expected = 'a number' if count == 1 else f'{count} numbers with spaces between them'
        todo = ''
        if _XACRO.search(text):
            todo = 'That is for xacro: xacro FILE prints the URDF.'
        elif ',' in text:
            todo = 'No commas: a space stands between two numbers, and a point in one.'
        raise self.wrong(
            element,
            f'{name} of <{element.tag}> of {where} is {quoted(text)}, and {expected} '
            f'{"is" if count == 1 else "are"} expected.',
            todo,
        )

    # -- lists ----------------------------------------------------------------------------------

    def _named(self, elements: list[Element], make: Callable[[Element], T]) -> dict[str, T]:
        found: dict[str, T] = {}
        for element in elements:
            self._check_tags(element)
            one = self._try(make, element)
            name = element.attributes.get('name', '')
            if one is not None and name in found:
                kind = element.tag
                self.wrong(
                    element,
                    f'There are two {kind}s {quoted(name)}.',
                    f'Each {kind} has a name of its own.',
                )
            elif one is not None:
                found[name] = one
        return found

    def _kept(
        self, make: Callable[[Element, str], T], elements: list[Element], where: str
    ) -> Iterable[T]:
        for element in elements:
            one = self._try(make, element, where)
            if one is not None:
                yield one

    def _try(self, make: Callable[..., T], *arguments: Element | str) -> T | None:
        try:
            return make(*arguments)
        except _Wrong:
            return None

    def _check_tags(self, element: Element) -> None:
        """Doubt tags that are nearly those that ROS reads: it leaves out what it does not know."""
        known = KNOWN[element.tag]
        for child in element.children:
            near = nearest(child.tag, known)
            if child.tag.startswith('xacro:'):
                self._say_xacro(child, f'<{child.tag}>')
            elif near and child.tag not in known:
                self.doubt(
                    child,
                    f'<{element.tag}> has a <{child.tag}>, which ROS does not read.',
                    f'Did you mean <{near}>?',
                )


def _loop(holders: dict[str, Joint]) -> list[str]:
    """Return links that hold each other, the first one twice; none if there are none."""
    safe: set[str] = set()
    for name in holders:
        way: list[str] = []
        while name in holders and name not in safe:
            if name in way:
                return [*way[way.index(name) :], name][::-1]
            way.append(name)
            name = holders[name].parent
        safe.update(way)
    return []


def _held(found: Description) -> Counter[str]:
    """Return how many links hang on each link that has no parent, itself included."""
    root_of: dict[str, str] = {}
    for name in found.links:
        way = []
        while name in found.holder and name not in root_of:
            way.append(name)
            name = found.holder[name].parent
        root = root_of.get(name, name)
        root_of.update(dict.fromkeys((*way, name), root))
    return Counter(root_of.values())
