"""Numbers for drawing from a robot's messages."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from labkit.sim.kinematics import Pose, Twist2, wrap_angle, yaw_from_quaternion
from labkit.sim.robots import BURGER

if TYPE_CHECKING:
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import LaserScan

__all__ = ['beam_ends', 'beams_of', 'motion_of', 'nearest_of', 'scanner_place']


# The page has numbers of single precision.
_MOST = 3.4e38


def motion_of(message: Odometry) -> tuple[Pose, Twist2] | None:
    """Return pose and velocity from odometry; None if a number is too large for a picture."""
    position, turn = message.pose.pose.position, message.pose.pose.orientation
    yaw = yaw_from_quaternion(turn.x, turn.y, turn.z, turn.w)
    speeds = message.twist.twist
    numbers = (position.x, position.y, yaw, speeds.linear.x, speeds.angular.z)
    if not all(abs(number) <= _MOST for number in numbers):  # nor NaN
        return None
    return Pose(*numbers[:3]), Twist2(*numbers[3:])


def beam_ends(message: LaserScan, pose: Pose) -> Any:
    """Return the ends of a scan's beams: x and y, m; NaN where a beam hit nothing."""
    ranges, angles = beams_of(message)
    eye_x, eye_y = scanner_place(pose)
    x, y = eye_x + ranges * np.cos(pose.yaw + angles), eye_y + ranges * np.sin(pose.yaw + angles)
    return np.stack([x, y], axis=1)


def scanner_place(pose: Pose) -> tuple[float, float]:
    """Return the position of a robot's scanner, x and y in m."""
    ahead = BURGER.scan_x
    return pose.x + ahead * math.cos(pose.yaw), pose.y + ahead * math.sin(pose.yaw)


def nearest_of(message: LaserScan) -> tuple[float, float] | None:
    """Return distance and direction of the nearest obstacle, None if there is none."""
    ranges, angles = beams_of(message)
    if np.isnan(ranges).all():
        return None
    beam = int(np.nanargmin(ranges))
    return float(ranges[beam]), wrap_angle(float(angles[beam]))


def beams_of(message: LaserScan) -> tuple[Any, Any]:
    """Return ranges, m, NaN where invalid, and directions, rad."""
    ranges = np.array(message.ranges, dtype=np.float64)
    # REP 117: +inf is nothing, -inf too near. Some drivers write 0 for nothing.
    good = np.isfinite(ranges) & (ranges >= message.range_min) & (ranges <= message.range_max)
    ranges[~good] = np.nan
    return ranges, message.angle_min + message.angle_increment * np.arange(len(ranges))
