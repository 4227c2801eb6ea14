"""What a robot's messages say, as numbers to be drawn."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from labkit.sim.kinematics import BURGER, Pose, Twist2, wrap_angle, yaw_from_quaternion

if TYPE_CHECKING:
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import LaserScan

__all__ = ['beam_ends', 'motion_of', 'nearest_of', 'scanner_place']


def motion_of(message: Odometry) -> tuple[Pose, Twist2] | None:
    """Return where a robot is and how fast it moves; None if its odometry is no number."""
    position, turn = message.pose.pose.position, message.pose.pose.orientation
    yaw = yaw_from_quaternion(turn.x, turn.y, turn.z, turn.w)
    speeds = message.twist.twist
    numbers = (position.x, position.y, yaw, speeds.linear.x, speeds.angular.z)
    if not all(map(math.isfinite, numbers)):
        return None
    return Pose(*numbers[:3]), Twist2(*numbers[3:])


def beam_ends(message: LaserScan, pose: Pose) -> Any:
    """Return where the beams of a scan end: x and y, m; not a number where one met nothing.

    Args:
        message: The scan.
        pose: Where the robot is.
    """
    ranges, angles = _beams(message)
    eye_x, eye_y = scanner_place(pose)
    x, y = eye_x + ranges * np.cos(pose.yaw + angles), eye_y + ranges * np.sin(pose.yaw + angles)
    return np.stack([x, y], axis=1)


def scanner_place(pose: Pose) -> tuple[float, float]:
    """Return where the scanner of a robot is, x and y in m."""
    ahead = BURGER.scan_x
    return pose.x + ahead * math.cos(pose.yaw), pose.y + ahead * math.sin(pose.yaw)


def nearest_of(message: LaserScan) -> tuple[float, float] | None:
    """Return distance and direction of what is nearest, None if nothing is seen."""
    ranges, angles = _beams(message)
    if np.isnan(ranges).all():
        return None
    beam = int(np.nanargmin(ranges))
    return float(ranges[beam]), wrap_angle(float(angles[beam]))


def _beams(message: LaserScan) -> tuple[Any, Any]:
    """Return distances, m, not a number where there is none, and directions, rad."""
    ranges = np.array(message.ranges, dtype=np.float64)
    # REP 117: +inf is nothing, -inf too near. Some drivers write 0 for nothing.
    good = np.isfinite(ranges) & (ranges >= message.range_min) & (ranges <= message.range_max)
    ranges[~good] = np.nan
    return ranges, message.angle_min + message.angle_increment * np.arange(len(ranges))
