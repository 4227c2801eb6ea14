"""Where the links of a robot are, from the positions of its joints."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from labkit.descriptions.links_and_joints import Description, Joint
from labkit.transforms.rotations import Quaternion, Vector, product, rotated

__all__ = ['Transform', 'all_positions', 'joint_transform', 'link_transforms']


class Transform(NamedTuple):
    """Where a frame is in another one.

    Attributes:
        translation: Its origin, m.
        rotation: Its turn, a quaternion (x, y, z, w) of length 1.
    """

    translation: Vector = (0.0, 0.0, 0.0)
    rotation: Quaternion = (0.0, 0.0, 0.0, 1.0)

    def __mul__(self, inner: Transform) -> Transform:  # type: ignore[override]
        """Return where the frame is that has the transform `inner` in this one."""
        x, y, z = rotated(self.rotation, inner.translation)
        here = self.translation
        place = (here[0] + x, here[1] + y, here[2] + z)
        return Transform(place, product(self.rotation, inner.rotation))

    def apply(self, point: Vector) -> Vector:
        """Return a point of this frame in the other one, m."""
        x, y, z = rotated(self.rotation, point)
        here = self.translation
        return here[0] + x, here[1] + y, here[2] + z


def all_positions(description: Description, positions: Mapping[str, float]) -> dict[str, float]:
    """Return positions with those of the joints that follow others, rad or m.

    As `robot_state_publisher` has it: a joint that follows one without a position has none, and
    one with a position of its own keeps it.
    """
    found = dict(positions)
    # A joint may follow one that follows another.
    waiting = [j for j in description.joints.values() if j.mimic and j.name not in found]
    while waiting:
        ready = [joint for joint in waiting if joint.mimic and joint.mimic.joint in found]
        if not ready:
            break
        for joint in ready:
            assert joint.mimic is not None
            leader = found[joint.mimic.joint]
            found[joint.name] = leader * joint.mimic.multiplier + joint.mimic.offset
        waiting = [joint for joint in waiting if joint.name not in found]
    return found


def joint_transform(joint: Joint, position: float = 0.0) -> Transform:
    """Return where the child of a joint is in its parent.

    Args:
        joint: The joint. One that is fixed, floating or planar stands at its origin.
        position: rad, or m.
    """
    origin = Transform(joint.origin.xyz, joint.origin.turn)
    if not joint.moves or not position:
        return origin
    x, y, z = joint.axis
    if joint.type == 'prismatic':
        return origin * Transform((x * position, y * position, z * position))
    sin, cos = math.sin(position / 2), math.cos(position / 2)
    return origin * Transform(rotation=(x * sin, y * sin, z * sin, cos))


def link_transforms(
    description: Description, positions: Mapping[str, float] | None = None
) -> dict[str, Transform]:
    """Return where each link is in the frame of the root.

    Args:
        description: The robot.
        positions: Positions of joints by their names, rad or m; 0 for those that are missing.
    """
    resting = dict.fromkeys((joint.name for joint in description.free_joints), 0.0)
    known = all_positions(description, {**resting, **(positions or {})})
    found = {description.root: Transform()}
    for joint in description.ordered:
        step = joint_transform(joint, known.get(joint.name, 0.0))
        found[joint.child] = found[joint.parent] * step
    return found
