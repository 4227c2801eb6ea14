"""Scans, their clouds, and those in another frame: recorded with the real packages."""

from __future__ import annotations

import math
from typing import Any

from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import LaserScan, PointCloud2

__all__ = ['CASES', 'cloud_of', 'told']

# Ranges, cutoff, sum of the channels.
CASES: list[tuple[list[float], float, int]] = [
    ([1.0, 2.0, math.inf, 0.0, math.nan, 3.5, 3.4999, 0.12, 0.1199, -math.inf], -1.0, 0x03),
    ([1.0, 2.0, 3.0], 2.5, 0x00),
    ([1.0, 2.0, 3.0], 99.0, 0x02),
    ([1.0, 2.0, 3.0, 0.5], -1.0, 0x1F),
    ([0.25] * 12, -1.0, 0x0C),
    ([0.0, math.inf], -1.0, 0x1F),
]


def cloud_of(laser_geometry: Any, case: tuple[list[float], float, int]) -> PointCloud2:
    """Return the cloud of a case, by a module `laser_geometry`."""
    ranges, cutoff, channels = case
    scan = LaserScan(
        angle_min=-0.5,
        angle_increment=math.tau / 360,
        time_increment=0.001,
        range_min=0.12,
        range_max=3.5,
        ranges=ranges,
        intensities=[10.0 * number for number in range(len(ranges))],
    )
    scan.header.frame_id, scan.header.stamp.sec = 'base_scan', 7
    scan.angle_max = scan.angle_min + (len(ranges) - 1) * scan.angle_increment
    return laser_geometry.LaserProjection().projectLaser(scan, cutoff, channels)


def told(cloud: PointCloud2, sensor_msgs_py: Any, tf2_sensor_msgs: Any) -> dict[str, Any]:
    """Return what a cloud has, and its points there and in another frame."""
    transform = TransformStamped()
    transform.header.frame_id, transform.header.stamp.sec = 'odom', 9
    shift, turn = transform.transform.translation, transform.transform.rotation
    shift.x, shift.y, shift.z = 1.0, -2.0, 0.5
    turn.x, turn.y, turn.z, turn.w = 0.1, 0.2, -0.3, 0.9
    moved = tf2_sensor_msgs.do_transform_cloud(cloud, transform)
    return {
        'fields': [[one.name, one.offset, one.datatype, one.count] for one in cloud.fields],
        'size': [cloud.width, cloud.height, cloud.point_step, cloud.row_step],
        'header': [cloud.header.frame_id, moved.header.frame_id, moved.header.stamp.sec],
        'points': sensor_msgs_py.read_points(cloud).tolist(),
        'moved': sensor_msgs_py.read_points(moved).tolist(),
    }
