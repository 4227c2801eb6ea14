"""What ROS takes of a description, though nobody can have meant it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

from labkit.descriptions.links_and_joints import (
    Box,
    Collision,
    Cylinder,
    Description,
    Geometry,
    Inertial,
    Joint,
    Link,
    Mesh,
    Origin,
    Sphere,
    Visual,
)
from labkit.descriptions.meshes import find_mesh
from labkit.descriptions.urdf_problems import Problem
from labkit.errors import LabError, quoted

__all__ = ['doubts', 'principal_moments']

# One turn, and a little for numbers that are rounded, rad.
MOST_TURN = math.tau + 0.01
# Real joints have limits of a few turns, rad. Those of wheels are sometimes huge, as 1e16.
MOST_LIMIT, HUGE = 4 * math.tau, 1000.0
# The triangle inequality holds for bodies that are infinitely thin, too; numbers are rounded.
ROUNDING = 1e-3


def doubts(description: Description, folder: Path | None = None) -> list[Problem]:
    """Return what nobody can have meant.

    Args:
        description: The robot.
        folder: Where meshes with paths that are relative are looked for.
    """
    found: list[Problem] = []
    for link in description.links.values():
        found += _of_link(link, folder)
    for joint in description.joints.values():
        found += _of_joint(joint)
    return found


def _of_link(link: Link, folder: Path | None) -> Iterator[Problem]:
    where = f'link {quoted(link.name)}'
    looked: set[Mesh] = set()
    parts: tuple[Visual | Collision, ...] = (*link.visuals, *link.collisions)
    for part in parts:
        yield from _of_origin(part.origin, where, link.line)
        yield from _of_shape(part, where, link.line)
        mesh = part.geometry
        if isinstance(mesh, Mesh) and mesh not in looked:
            looked.add(mesh)
            try:
                find_mesh(mesh.filename, folder)
            except LabError as error:
                yield Problem(f'{where}: {error.message}', error.todo, link.line)
    if link.inertial is not None:
        yield from _of_origin(link.inertial.origin, where, link.line)
        yield from _of_inertial(link.inertial, where, link.line)


def _of_origin(origin: Origin, where: str, line: int) -> Iterator[Problem]:
    angle = max(origin.rpy, key=abs)
    if abs(angle) > MOST_TURN:
        yield Problem(
            f'{where} has an <origin> with an angle of {angle:g}: angles of rpy are in rad, and '
            f'that is {abs(angle) / math.tau:.1f} turns.',
            f'If {angle:g} degrees are meant, write {math.radians(angle):.4f}.',
            line,
        )


def _of_shape(part: Visual | Collision, where: str, line: int) -> Iterator[Problem]:
    sizes = _sizes(part.geometry)
    if min(sizes.values()) <= 0 and not isinstance(part.geometry, Mesh):
        name, size = min(sizes.items(), key=lambda pair: pair[1])
        yield Problem(
            f'{where} has a {type(part.geometry).__name__.lower()} whose {name} is {size:g}, and '
            'a size is more than 0 m.',
            line=line,
        )
    elif isinstance(part.geometry, Mesh) and 0 in sizes.values():
        yield Problem(f'{where} has a mesh that is scaled to nothing.', line=line)
    elif max(sizes.values()) >= HUGE and not isinstance(part.geometry, Mesh):
        name, size = max(sizes.items(), key=lambda pair: pair[1])
        yield Problem(
            f'{where} is {size:g} m large ({name} of its {type(part.geometry).__name__.lower()}).',
            f'Sizes are in m. If {size:g} mm are meant, write {size / 1000:g}.',
            line,
        )


def _sizes(geometry: Geometry) -> dict[str, float]:
    if isinstance(geometry, Box):
        return dict(zip(('x', 'y', 'z'), geometry.size, strict=True))
    if isinstance(geometry, Cylinder):
        return {'radius': geometry.radius, 'length': geometry.length}
    if isinstance(geometry, Sphere):
        return {'radius': geometry.radius}
    return dict(zip('xyz', map(abs, geometry.scale), strict=True))


def _of_inertial(inertial: Inertial, where: str, line: int) -> Iterator[Problem]:
    if inertial.mass <= 0:
        yield Problem(
            f'{where} has the mass {inertial.mass:g} kg, and a body has more than 0. With 0, '
            'physics can not move it.',
            'Weigh it, or leave its <inertial> out: then it is only a frame.',
            line,
        )
        return
    small, middle, large = principal_moments(inertial.inertia)
    if small < -ROUNDING * abs(large) or large <= 0:
        yield Problem(
            f'{where} has an inertia that no body can have: about one of its axes it is '
            f'{small:.3g} kg m², and it is more than 0 about each.',
            _box_inertia(inertial.mass),
            line,
        )
    elif small + middle < large * (1 - ROUNDING):
        yield Problem(
            f'{where} has an inertia that no body can have: about its main axes it is '
            f'{small:.3g}, {middle:.3g} and {large:.3g} kg m², and the largest is at most the sum '
            'of the other two.',
            _box_inertia(inertial.mass),
            line,
        )


def _box_inertia(mass: float) -> str:
    return (
        f'A box of {mass:g} kg, a by b by c m, has ixx = {mass:g}/12 (b² + c²), iyy = {mass:g}/12 '
        f'(a² + c²), izz = {mass:g}/12 (a² + b²), and 0 for the others.'
    )


def principal_moments(
    inertia: tuple[float, float, float, float, float, float],
) -> tuple[float, float, float]:
    """Return the moments of inertia about the main axes, in order, kg m².

    They are the eigenvalues of the matrix. Source: Smith, "Eigenvalues of a symmetric 3 x 3
    matrix", Communications of the ACM 4 (1961).

    Args:
        inertia: ixx, ixy, ixz, iyy, iyz, izz.
    """
    xx, xy, xz, yy, yz, zz = inertia
    mean = (xx + yy + zz) / 3
    a, b, c = xx - mean, yy - mean, zz - mean
    spread = math.sqrt((a * a + b * b + c * c + 2 * (xy * xy + xz * xz + yz * yz)) / 6)
    if spread == 0:
        return mean, mean, mean
    determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz)
    angle = math.acos(min(max(determinant / (2 * spread**3), -1.0), 1.0)) / 3
    large = mean + 2 * spread * math.cos(angle)
    small = mean + 2 * spread * math.cos(angle + math.tau / 3)
    return small, 3 * mean - large - small, large


def _of_joint(joint: Joint) -> Iterator[Problem]:
    where = f'joint {quoted(joint.name)}'
    yield from _of_origin(joint.origin, where, joint.line)
    limits = joint.limits
    if limits is None or joint.type not in ('revolute', 'prismatic'):
        return
    lower, upper = limits.lower, limits.upper
    if lower > upper:
        yield Problem(
            f'{where} has the limits {lower:g} to {upper:g}, and the lower one is the smaller.',
            f'lower="{upper:g}" upper="{lower:g}"',
            joint.line,
        )
    elif lower == upper:
        yield Problem(
            f'{where} is {joint.type} and can not move: lower and upper are both {lower:g}.',
            'What can not move is of type fixed.',
            joint.line,
        )
    widest = max(abs(lower), abs(upper))
    if joint.type == 'revolute' and MOST_LIMIT < widest <= HUGE:
        yield Problem(
            f'{where} may turn to {widest:g}: limits are in rad, and that is '
            f'{widest / math.tau:.1f} turns.',
            f'If degrees are meant: lower="{math.radians(lower):.4f}" '
            f'upper="{math.radians(upper):.4f}". What turns without end is of type continuous.',
            joint.line,
        )
