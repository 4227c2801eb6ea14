"""Where one frame is in another, as a judge calculates with it: a shift and a turn."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from labkit.exercises.figures import figure
from labkit.transforms.rotations import (
    Quaternion,
    Vector,
    from_rpy,
    interpolated,
    inverse,
    product,
    rotated,
    slerp,
)

__all__ = ['TF', 'Place', 'degrees', 'metres', 'on_floor']

TF = 'tf2_msgs/msg/TFMessage'
# How far the length of a quaternion may be off: a learner may round.
LENGTH = 0.01


class Place(NamedTuple):
    """Where a frame is in its parent.

    Attributes:
        shift: The place of its origin, m.
        turn: How it is turned, a quaternion x, y, z, w.
    """

    shift: Vector
    turn: Quaternion = (0.0, 0.0, 0.0, 1.0)

    @staticmethod
    def of(transform: Any) -> Place:
        """Return that of a geometry_msgs/msg/Transform."""
        t, r = transform.translation, transform.rotation
        return Place((t.x, t.y, t.z), (r.x, r.y, r.z, r.w))

    def stamped(self, parent: str, child: str, nanoseconds: int) -> Any:
        """Return it as a geometry_msgs/msg/TransformStamped of a time, ns."""
        from geometry_msgs.msg import TransformStamped

        found = TransformStamped(child_frame_id=child)
        found.header.frame_id = parent
        stamp = found.header.stamp
        stamp.sec, stamp.nanosec = divmod(nanoseconds, 10**9)
        t, r = found.transform.translation, found.transform.rotation
        t.x, t.y, t.z = self.shift
        r.x, r.y, r.z, r.w = self.turn
        return found

    def has(self, point: Vector) -> Vector:
        """Return a point of this frame as it is in the parent."""
        x, y, z = rotated(self.turn, point)
        return x + self.shift[0], y + self.shift[1], z + self.shift[2]

    def then(self, inner: Place) -> Place:
        """Return where a frame is in the parent that is given in this one."""
        return Place(self.has(inner.shift), product(self.turn, inner.turn))

    @property
    def back(self) -> Place:
        """Where the parent is in this frame."""
        back = inverse(self.turn)
        x, y, z = rotated(back, self.shift)
        return Place((-x, -y, -z), back)

    def between(self, later: Place, ratio: float) -> Place:
        """Return the place on the way to a later one."""
        shift = interpolated(self.shift, later.shift, ratio)
        return Place(shift, slerp(self.turn, later.turn, ratio))

    @property
    def length(self) -> float:
        """The length of the quaternion, which should be 1."""
        return math.hypot(*self.turn)

    @property
    def is_rotation(self) -> bool:
        """Whether that is so, nearly."""
        return abs(self.length - 1) <= LENGTH

    def away(self, other: Place) -> float:
        """Return how far the origin of another one is away, m."""
        return math.dist(self.shift, other.shift)

    def turned(self, other: Place) -> float:
        """Return by what angle another one is turned against it, rad."""
        size = self.length * other.length
        dot = sum(a * b for a, b in zip(self.turn, other.turn, strict=True))
        return 2 * math.acos(min(1.0, abs(dot) / size)) if size else math.pi


def on_floor(x: float, y: float, yaw: float, z: float = 0.0) -> Place:
    """Return a place with x, y and z in m, turned to the left by an angle in rad."""
    return Place((x, y, z), from_rpy(0.0, 0.0, yaw))


def metres(point: Vector) -> str:
    """Return a point in words."""
    return ', '.join(f'{name} = {figure(part)} m' for name, part in zip('xyz', point, strict=True))


def degrees(turn: Quaternion) -> str:
    """Return a quaternion in words, with its yaw."""
    x, y, z, w = turn
    yaw = math.degrees(math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
    parts = ', '.join(f'{name} = {figure(part)}' for name, part in zip('xyzw', turn, strict=True))
    return f'{parts}, which is a yaw of {yaw:.0f}°'
