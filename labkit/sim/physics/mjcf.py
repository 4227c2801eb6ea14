"""Worlds and robots as MuJoCo reads them, in MJCF: a text of XML."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from xml.sax.saxutils import quoteattr

from labkit.descriptions.forward_kinematics import Transform, joint_transform
from labkit.descriptions.links_and_joints import (
    Box,
    Cylinder,
    Description,
    Geometry,
    Sphere,
)
from labkit.sim.camera import POST_HEIGHT, WALL_HEIGHT
from labkit.sim.physics.things import Crate, Ice, Ramp
from labkit.sim.world import Post, World
from labkit.transforms.rotations import from_rpy

__all__ = ['ICE_THICKNESS', 'STEP', 'mjcf_of_robot', 'mjcf_of_world']

# Time of a step, s: sixteen of them are a round of the robot's 30 Hz.
STEP = 1 / 480
# Half the thickness of a wall, m: those of the map have none, and laser scans are to agree.
WALL_HALF = 0.002
# How thick ice lies on the floor, m: thin enough for the robot's caster, which is 6 mm high.
ICE_THICKNESS = 0.001
# Friction of rubber on a floor, of a ball of steel, and of all that has none of its own. Of two
# that touch the larger one counts, so floor and ramps have little: each thing brings its own.
RUBBER, BALL, USUAL = 0.9, 0.02, 0.5
# Torque of a wheel's motor when it stands, N m. Source: ROBOTIS e-manual, XL430-W250, "Stall
# Torque" at 11.1 V. Its controller holds a speed: 1 N m for 1 rad/s too slow.
STALL_TORQUE, GAIN = 1.4, 1.0
# Inertia of the motor and its gears as the wheel feels it, kg m²: no published number, chosen
# small beside that of the robot, m r² = 1e-3, and large enough for steps of this length.
ARMATURE = 1e-4


def mjcf_of_world(
    plan: World,
    crates: Iterable[Crate],
    ice: Iterable[Ice],
    ramps: Iterable[Ramp],
    bodies: Iterable[str] = (),
    motors: Iterable[str] = (),
) -> str:
    """Return a world in MJCF, with robots from `mjcf_of_robot`."""
    lines = [
        '<mujoco>',
        '<compiler angle="radian" fusestatic="true"/>',
        f'<option timestep="{STEP!r}" integrator="implicitfast" cone="elliptic"/>',
        f'<default><geom solref="0.006 1" friction="{USUAL} 0.002 0.0001"/></default>',
        '<worldbody>',
        f'<geom name="floor" type="plane" size="0 0 1" friction="{BALL} 0.002 0.0001"/>',
        *_walls(plan),
        *(_ice(number, each) for number, each in enumerate(ice)),
        *(_ramp(number, each) for number, each in enumerate(ramps)),
        *(_crate(number, each) for number, each in enumerate(crates)),
        *bodies,
        '</worldbody>',
        f'<actuator>{"".join(motors)}</actuator>',
        '</mujoco>',
    ]
    return '\n'.join(lines)


def _walls(plan: World) -> Iterator[str]:
    for number, wall in enumerate(plan.walls):
        along_x, along_y = wall.x2 - wall.x1, wall.y2 - wall.y1
        half = math.hypot(along_x, along_y) / 2 + WALL_HALF
        yield _geom(
            f'wall{number}',
            'box',
            (half, WALL_HALF, WALL_HEIGHT / 2),
            ((wall.x1 + wall.x2) / 2, (wall.y1 + wall.y2) / 2, WALL_HEIGHT / 2),
            math.atan2(along_y, along_x),
        )
    for number, post in enumerate(plan.posts):
        yield _post(number, post)


def _post(number: int, post: Post) -> str:
    half = POST_HEIGHT / 2
    return _geom(f'post{number}', 'cylinder', (post.radius, half), (post.x, post.y, half))


def _ice(number: int, ice: Ice) -> str:
    # Of two geoms the one with the higher priority says how slippery the contact is.
    half = ICE_THICKNESS / 2
    size = ice.width / 2, ice.height / 2, half
    more = f' priority="1" friction="{ice.friction!r} 0.0001 0.00001"'
    return _geom(f'ice{number}', 'box', size, (ice.x, ice.y, half), more=more)


def _ramp(number: int, ramp: Ramp) -> str:
    # A board that lies on the floor with its lower edge; below it, it is open.
    half, thick = math.hypot(ramp.length, ramp.rise) / 2, 0.01
    cos, sin = math.cos(ramp.slope), math.sin(ramp.slope)
    ahead, up = half * cos + thick * sin, half * sin - thick * cos
    x = ramp.x + ahead * math.cos(ramp.yaw)
    y = ramp.y + ahead * math.sin(ramp.yaw)
    place = Transform((x, y, up), from_rpy(0.0, -ramp.slope, ramp.yaw))
    return (
        f'<geom name="ramp{number}" type="box" size="{half!r} {ramp.width / 2!r} {thick!r}" '
        f'{_pose(place)} friction="{BALL} 0.002 0.0001"/>'
    )


def _crate(number: int, crate: Crate) -> str:
    half = crate.size / 2
    return (
        f'<body name="crate{number}" pos="{crate.x!r} {crate.y!r} {half!r}" '
        f'euler="0 0 {crate.yaw!r}"><freejoint name="crate{number}"/><geom name="crate{number}" '
        f'type="box" size="{half!r} {half!r} {half!r}" mass="{crate.mass!r}" '
        f'friction="{crate.friction!r} 0.002 0.0001"/></body>'
    )


def _geom(
    name: str,
    kind: str,
    size: tuple[float, ...],
    place: tuple[float, float, float],
    yaw: float = 0.0,
    *,
    more: str = '',
) -> str:
    sizes, at = (' '.join(map(repr, numbers)) for numbers in (size, place))
    return (
        f'<geom name="{name}" type="{kind}" size="{sizes}" pos="{at}" euler="0 0 {yaw!r}"{more}/>'
    )


# --- Robots --------------------------------------------------------------------------------------


def mjcf_of_robot(name: str, robot: Description, wheels: tuple[str, str]) -> tuple[str, str]:
    """Return a robot in MJCF: its body, and its motors.

    Args:
        name: Its name in the world.
        robot: Its links. Those that are fixed to each other become one body.
        wheels: The joints of the wheels that are driven.
    """
    motors = ''.join(
        f'<velocity name={_named(name, wheel)} joint={_named(name, wheel)} kv="{GAIN}" '
        f'ctrlrange="-1000 1000" forcerange="{-STALL_TORQUE} {STALL_TORQUE}"/>'
        for wheel in wheels
    )
    return ''.join(_body(name, robot, robot.root, wheels)), motors


def _named(robot: str, name: str) -> str:
    return quoteattr(f'{robot}:{name}')


def _body(name: str, robot: Description, link: str, wheels: tuple[str, str]) -> Iterator[str]:
    holder = robot.holder.get(link)
    pose = '' if holder is None else _pose(joint_transform(holder))
    yield f'<body name={_named(name, link)} {pose}>'
    if holder is None:
        yield f'<freejoint name={_named(name, "root")}/>'
    elif holder.moves:
        kind = 'slide' if holder.type == 'prismatic' else 'hinge'
        axis = ' '.join(map(repr, holder.axis))
        armature = ARMATURE if holder.name in wheels else 0.0
        yield (
            f'<joint name={_named(name, holder.name)} type="{kind}" axis="{axis}" '
            f'damping="{holder.dynamics.damping!r}" armature="{armature!r}"/>'
        )
    part = robot.links[link]
    if part.inertial is not None:
        xx, xy, xz, yy, yz, zz = part.inertial.inertia
        whole = ' '.join(map(repr, (xx, yy, zz, xy, xz, yz)))
        x, y, z = part.inertial.origin.xyz
        yield (
            f'<inertial pos="{x!r} {y!r} {z!r}" mass="{part.inertial.mass!r}" '
            f'fullinertia="{whole}"/>'
        )
    friction = USUAL
    if holder is not None and holder.name in wheels:
        friction = RUBBER
    elif 'caster' in link:
        friction = BALL
    for collision in part.collisions:
        shape = _shape(collision.geometry)
        if shape:
            place = Transform(collision.origin.xyz, collision.origin.turn)
            yield f'<geom {shape} {_pose(place)} friction="{friction} 0.002 0.0001"/>'
    for joint in robot.joints.values():
        if joint.parent == link:
            yield from _body(name, robot, joint.child, wheels)
    yield '</body>'


def _shape(geometry: Geometry) -> str:
    """Return a shape in MJCF, '' for a mesh: only its file could tell."""
    if isinstance(geometry, Box):
        half = ' '.join(repr(size / 2) for size in geometry.size)
        return f'type="box" size="{half}"'
    if isinstance(geometry, Cylinder):
        return f'type="cylinder" size="{geometry.radius!r} {geometry.length / 2!r}"'
    if isinstance(geometry, Sphere):
        return f'type="sphere" size="{geometry.radius!r}"'
    return ''


def _pose(place: Transform) -> str:
    at = ' '.join(map(repr, place.translation))
    x, y, z, w = place.rotation
    return f'pos="{at}" quat="{w!r} {x!r} {y!r} {z!r}"'
