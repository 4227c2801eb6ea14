"""What a robot consists of: links with shapes, and the joints between them.

Names and units are those of URDF: m, rad, kg, kg m², N or N m. Source: wiki.ros.org/urdf/XML, and
the parser that ROS uses, ros/urdfdom, urdf_parser/src.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field

from labkit.transforms.rotations import Quaternion, Vector, from_rpy

__all__ = [
    'MOVING',
    'TYPES',
    'Box',
    'Collision',
    'Cylinder',
    'Description',
    'Dynamics',
    'Geometry',
    'Inertial',
    'Joint',
    'Limits',
    'Link',
    'Material',
    'Mesh',
    'Mimic',
    'Origin',
    'Sphere',
    'Visual',
]

ZERO: Vector = (0.0, 0.0, 0.0)
# The types of joints that one number moves, and all types.
MOVING = ('revolute', 'continuous', 'prismatic')
TYPES = (*MOVING, 'fixed', 'floating', 'planar')
# What has neither a colour nor a material is grey, as in RViz.
GREY = (0.7, 0.7, 0.7, 1.0)


@dataclass(frozen=True)
class Origin:
    """A place and a turn, relative to another frame.

    Attributes:
        xyz: The place, m.
        rpy: The turn: angles about the fixed x axis, then y, then z, rad.
    """

    xyz: Vector = ZERO
    rpy: Vector = ZERO

    @property
    def turn(self) -> Quaternion:
        """The turn as a quaternion (x, y, z, w)."""
        return from_rpy(*self.rpy)


@dataclass(frozen=True)
class Box:
    """A box around its origin; `size` along x, y and z, m."""

    size: Vector


@dataclass(frozen=True)
class Cylinder:
    """A cylinder around its origin, along z; m."""

    radius: float
    length: float


@dataclass(frozen=True)
class Sphere:
    """A sphere around its origin; m."""

    radius: float


@dataclass(frozen=True)
class Mesh:
    """A shape from a file.

    Attributes:
        filename: Where it is, as written: `package://NAME/path`, `file:///path`, or a path.
        scale: What its coordinates are multiplied by, to be m.
    """

    filename: str
    scale: Vector = (1.0, 1.0, 1.0)


Geometry = Box | Cylinder | Sphere | Mesh


@dataclass(frozen=True)
class Material:
    """A colour, or a picture.

    Attributes:
        name: Its name, '' if it has none.
        rgba: Red, green, blue and how opaque it is, each from 0 to 1.
        texture: Where the picture is, '' if there is none.
    """

    name: str = ''
    rgba: tuple[float, float, float, float] = GREY
    texture: str = ''


@dataclass(frozen=True)
class Visual:
    """What is seen of a link."""

    geometry: Geometry
    origin: Origin = Origin()
    material: Material = Material()
    name: str = ''


@dataclass(frozen=True)
class Collision:
    """What others touch of a link."""

    geometry: Geometry
    origin: Origin = Origin()
    name: str = ''


@dataclass(frozen=True)
class Inertial:
    """How heavy a link is, and how hard to turn.

    Attributes:
        mass: kg.
        inertia: ixx, ixy, ixz, iyy, iyz, izz about its origin, kg m².
        origin: The centre of mass.
    """

    mass: float
    inertia: tuple[float, float, float, float, float, float]
    origin: Origin = Origin()


@dataclass(frozen=True)
class Link:
    """A rigid part; its frame has its name.

    Attributes:
        line: Where it stands in the file, 0 if it comes from none.
    """

    name: str
    visuals: tuple[Visual, ...] = ()
    collisions: tuple[Collision, ...] = ()
    inertial: Inertial | None = None
    line: int = field(default=0, compare=False, repr=False)


@dataclass(frozen=True)
class Limits:
    """How far a joint goes, rad or m, how hard it pushes, N m or N, how fast, rad/s or m/s."""

    lower: float = 0.0
    upper: float = 0.0
    effort: float = 0.0
    velocity: float = 0.0


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another one: multiplier * position of that + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Dynamics:
    """What brakes a joint: damping, N m s/rad or N s/m, and friction, N m or N."""

    damping: float = 0.0
    friction: float = 0.0


@dataclass(frozen=True)
class Joint:
    """A connection of two links.

    Attributes:
        type: One of `TYPES`.
        parent: The name of a link.
        child: The name of the link that it holds. Its frame is that of the joint.
        origin: The joint in the frame of the parent, at position 0.
        axis: What it turns about, or slides along, in its own frame, of length 1.
        limits: None if it has none.
        mimic: None if it follows no other.
        line: Where it stands in the file, 0 if it comes from none.
    """

    name: str
    type: str
    parent: str
    child: str
    origin: Origin = Origin()
    axis: Vector = (1.0, 0.0, 0.0)
    limits: Limits | None = None
    mimic: Mimic | None = None
    dynamics: Dynamics = Dynamics()
    line: int = field(default=0, compare=False, repr=False)

    @property
    def moves(self) -> bool:
        """Whether one number moves it."""
        return self.type in MOVING


@dataclass(frozen=True)
class Description:
    """A robot: a tree of links, with a joint for each but the first.

    Attributes:
        name: Its name.
        links: Its links by their names, in the order of the file.
        joints: Its joints by their names, likewise.
        materials: Materials that have a name, by that.
    """

    name: str
    links: dict[str, Link]
    joints: dict[str, Joint] = field(default_factory=dict)
    materials: dict[str, Material] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f'<Description {self.name!r}: {len(self.links)} links, {len(self.joints)} joints>'

    @functools.cached_property
    def holder(self) -> dict[str, Joint]:
        """The joint that holds each link; the root has none."""
        return {joint.child: joint for joint in self.joints.values()}

    @property
    def root(self) -> str:
        """The name of the link that no joint holds."""
        return next(name for name in self.links if name not in self.holder)

    @functools.cached_property
    def ordered(self) -> tuple[Joint, ...]:
        """All joints, each after the one that holds its parent."""
        of_parent: dict[str, list[Joint]] = {}
        for joint in self.joints.values():
            of_parent.setdefault(joint.parent, []).append(joint)
        found = list(of_parent.get(self.root, ()))
        for joint in found:  # which grows meanwhile
            found += of_parent.get(joint.child, ())
        return tuple(found)

    @property
    def free_joints(self) -> tuple[Joint, ...]:
        """The joints that a number moves and that follow no other one: those of /joint_states."""
        return tuple(j for j in self.joints.values() if j.moves and j.mimic is None)
