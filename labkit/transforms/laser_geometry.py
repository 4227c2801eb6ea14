"""A laser scan as a cloud of points, as `laser_geometry` makes it.

Names, arguments and results are those of ros-perception/laser_geometry, branch rolling,
src/laser_geometry/laser_geometry.py. As there, all points are where they were at the stamp: what
the robot has moved during a turn of the scanner is not taken into account.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from sensor_msgs.msg import LaserScan, PointCloud2, PointField

from labkit.transforms.point_cloud2 import create_cloud, dtype_from_fields

__all__ = ['LaserProjection']


class LaserProjection:
    """Makes points of a scan, in the frame of the scanner: x ahead, y to the left, z up."""

    LASER_SCAN_INVALID = -1.0
    LASER_SCAN_MIN_RANGE = -2.0
    LASER_SCAN_MAX_RANGE = -3.0

    class ChannelOption:
        """What a point tells beside its place; add those that you want."""

        NONE = 0x00
        INTENSITY = 0x01
        INDEX = 0x02
        DISTANCE = 0x04
        TIMESTAMP = 0x08
        VIEWPOINT = 0x10
        DEFAULT = INTENSITY | INDEX

    def projectLaser(
        self,
        scan_in: LaserScan,
        range_cutoff: float = -1.0,
        channel_options: int = ChannelOption.DEFAULT,
    ) -> PointCloud2:
        """Return the points of a scan; beams out of range are left out.

        Args:
            scan_in: The scan.
            range_cutoff: Leave out what is farther, m. What is out of the scanner's range is left
                out anyway.
            channel_options: What to tell of each point, a sum of `ChannelOption`: its
                `intensity`, the `index` of its beam, its `distances` in m, its time `stamps` since
                the first beam in s, and the place `vp_x`, `vp_y`, `vp_z` of the scanner in m.
        """
        ranges = np.array(scan_in.ranges, dtype=np.float64)
        farthest = scan_in.range_max
        if range_cutoff >= 0:
            farthest = min(range_cutoff, farthest)
        (beams,) = np.nonzero((ranges < farthest) & (ranges >= scan_in.range_min))
        angles = scan_in.angle_min + beams * scan_in.angle_increment
        ranges = ranges[beams]
        columns = {'x': ranges * np.cos(angles), 'y': ranges * np.sin(angles), 'z': 0.0}
        option = self.ChannelOption
        if channel_options & option.INTENSITY and len(scan_in.intensities):
            columns['intensity'] = np.array(scan_in.intensities)[beams]
        if channel_options & option.INDEX:
            columns['index'] = beams
        if channel_options & option.DISTANCE:
            columns['distances'] = ranges
        if channel_options & option.TIMESTAMP:
            columns['stamps'] = beams * scan_in.time_increment
        if channel_options & option.VIEWPOINT:
            columns.update(vp_x=0.0, vp_y=0.0, vp_z=0.0)
        fields = [_field(name, 4 * number) for number, name in enumerate(columns)]
        points: Any = np.empty(len(beams), dtype_from_fields(fields))
        for name, column in columns.items():
            points[name] = column
        return create_cloud(scan_in.header, fields, points)


def _field(name: str, offset: int) -> PointField:
    kind = PointField.INT32 if name == 'index' else PointField.FLOAT32
    return PointField(name=name, offset=offset, datatype=kind, count=1)
