"""The motion of a robot with two driven wheels: pure mathematics in SI units, without ROS.

The robot is a unicycle: it drives along its own heading with v (m/s) and turns with w (rad/s).
Both are piecewise linear in time, since motors need time to speed up. While they are constant the
path is an arc with a closed form; while they change it is integrated to full precision. So the
result does not depend on the size of the time steps.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from labkit.sim.robots import DriveLimits, Robot

__all__ = [
    'STANDING',
    'Motion',
    'Pose',
    'Twist2',
    'believed',
    'ramp',
    'twist_of_wheels',
    'wheel_speeds',
    'wrap_angle',
    'yaw_from_quaternion',
    'yaw_to_quaternion',
]


class Pose(NamedTuple):
    """A pose in the plane.

    Attributes:
        x: Position along the x axis, m.
        y: Position along the y axis, m.
        yaw: Heading, rad, counter-clockwise from the x axis, in (-pi, pi].
    """

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0


class Twist2(NamedTuple):
    """A velocity in the plane, or its rate of change.

    Attributes:
        v: Speed along the heading, m/s (or m/s²); negative is backwards.
        w: Turning rate, rad/s (or rad/s²); positive is to the left.
    """

    v: float = 0.0
    w: float = 0.0


STANDING = Twist2()


def wrap_angle(angle: float) -> float:
    """Return an angle wrapped to (-pi, pi], rad."""
    if -math.pi < angle <= math.pi:
        return angle
    wrapped = math.remainder(angle, math.tau)
    return math.pi if wrapped <= -math.pi else wrapped


def yaw_to_quaternion(yaw: float) -> tuple[float, float, float, float]:
    """Return the quaternion (x, y, z, w) of a turn by `yaw` rad about the z axis."""
    return 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)


def yaw_from_quaternion(x: float, y: float, z: float, w: float) -> float:
    """Return the heading of a quaternion, rad, in (-pi, pi].

    The quaternion need not be normalized; roll and pitch are ignored.
    Source: Diebel, "Representing Attitude" (2006), equation 290.
    """
    return math.atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)


def wheel_speeds(twist: Twist2, robot: Robot) -> tuple[float, float]:
    """Return the speeds of the left and the right wheel, rad/s."""
    (v, w), radius = twist, robot.wheel_radius
    half = w * robot.wheel_separation / 2
    return (v - half) / radius, (v + half) / radius


def twist_of_wheels(left: float, right: float, robot: Robot) -> Twist2:
    """Return the twist of wheels that turn at speeds, rad/s: the inverse of `wheel_speeds`."""
    radius = robot.wheel_radius
    return Twist2(radius * (left + right) / 2, radius * (right - left) / robot.wheel_separation)


def believed(twist: Twist2, mismatch: float, robot: Robot) -> Twist2:
    """Return the twist that odometry computes when the wheels' radii differ.

    The left wheel is smaller than it should be, so it turns more often, and odometry overestimates
    its way; the right wheel is the opposite. This is the most common
    systematic error of odometry. Source: Borenstein and Feng, "Measurement and correction of
    systematic odometry errors in mobile robots", IEEE Trans. Robotics and Automation 12 (1996).

    Args:
        twist: The true twist, or the true acceleration.
        mismatch: Difference of the radii relative to their mean; 0 for perfect wheels.
        robot: The robot's dimensions.
    """
    if not mismatch:
        return twist
    width = robot.wheel_separation
    return Twist2(
        twist.v - mismatch * twist.w * width / 4,
        twist.w - mismatch * twist.v / width,
    )


def ramp(twist: Twist2, target: Twist2, limits: DriveLimits) -> tuple[Twist2, float]:
    """Return the acceleration towards `target`, and how long it stays constant, s.

    Args:
        twist: The current twist.
        target: The wanted twist.
        limits: Limits of the drive.

    Returns:
        The acceleration, and the time until a component reaches its target; infinity if both have.
    """
    if twist == target:
        return STANDING, math.inf
    v_gap, w_gap = target.v - twist.v, target.w - twist.w
    v_time = abs(v_gap) / limits.v_rate if v_gap else math.inf
    w_time = abs(w_gap) / limits.w_rate if w_gap else math.inf
    acceleration = Twist2(
        math.copysign(limits.v_rate, v_gap) if v_gap else 0.0,
        math.copysign(limits.w_rate, w_gap) if w_gap else 0.0,
    )
    return acceleration, min(v_time, w_time)


class Motion(NamedTuple):
    """Motion with constant acceleration.

    Attributes:
        start: Pose at time 0.
        twist: Twist at time 0.
        acceleration: Rate of change of the twist.
    """

    start: Pose
    twist: Twist2
    acceleration: Twist2 = STANDING

    def twist_at(self, time: float) -> Twist2:
        """Return the twist after `time` seconds."""
        return Twist2(
            self.twist.v + self.acceleration.v * time,
            self.twist.w + self.acceleration.w * time,
        )

    def fastest(self, time: float) -> Twist2:
        """Return the greatest absolute speeds within the first `time` seconds."""
        # They are linear in time, so the greatest ones are at an end.
        (v, w), (v_rate, w_rate) = self.twist, self.acceleration
        return Twist2(
            max(abs(v), abs(v + v_rate * time)),
            max(abs(w), abs(w + w_rate * time)),
        )

    def turned(self, time: float) -> float:
        """Return the change of heading after `time` seconds, rad, not wrapped."""
        return (self.twist.w + self.acceleration.w * time / 2) * time

    def pose_at(self, time: float) -> Pose:
        """Return the pose after `time` seconds."""
        if time == 0:
            return self.start
        (x, y, yaw), (v, w), (v_rate, w_rate) = self
        if w_rate or (v_rate and w):
            angle = self.turned(time)
            ahead, aside = self._integrate(time)
        else:
            # An arc; or a straight line, on which the speed may change. The chord of an arc of
            # length s that turns by a is s sin(a/2) / (a/2) long and points along a/2. Unlike
            # v/w (sin ...) this loses no digits when the arc is nearly straight.
            # Source: Thrun, Burgard and Fox, "Probabilistic Robotics" (2005), equation 5.9,
            # rearranged.
            angle = w * time
            half = angle / 2
            # Where sin(half)/half would divide 0 by 0, its series is exact to rounding.
            factor = math.sin(half) / half if abs(half) > 1e-4 else 1 - half * half / 6
            chord = (v + v_rate * time / 2) * time * factor
            ahead, aside = chord * math.cos(half), chord * math.sin(half)
        cos, sin = math.cos(yaw), math.sin(yaw)
        return Pose(
            x + cos * ahead - sin * aside,
            y + sin * ahead + cos * aside,
            wrap_angle(yaw + angle),
        )

    def _integrate(self, time: float) -> tuple[float, float]:
        """Return the displacement ahead and to the left, relative to the start, m."""
        # This is a Fresnel integral. Gauss-Legendre quadrature with 6 points is exact to rounding
        # as long as the heading turns by no more than half a radian per panel.
        panels = max(1, math.ceil(2 * self.fastest(time).w * time))
        half = time / panels / 2
        ahead = aside = 0.0
        for panel in range(panels):
            middle = (2 * panel + 1) * half
            for node, weight in _GAUSS_6:
                at = middle + node * half
                way = weight * half * (self.twist.v + self.acceleration.v * at)
                angle = self.turned(at)
                ahead += way * math.cos(angle)
                aside += way * math.sin(angle)
        return ahead, aside


# Nodes and weights on [-1, 1]. Source: Abramowitz and Stegun (1964), table 25.4, n = 6.
_GAUSS_6 = tuple(
    (sign * node, weight)
    for node, weight in (
        (0.238619186083196909, 0.467913934572691047),
        (0.661209386466264514, 0.360761573048138608),
        (0.932469514203152028, 0.171324492379170345),
    )
    for sign in (-1, 1)
)
