"""Point clouds in another frame.

Results are those of the real functions (ros2/geometry2, branch jazzy,
tf2_sensor_msgs/tf2_sensor_msgs/tf2_sensor_msgs.py); the stamp stays that of the cloud.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from geometry_msgs.msg import Transform, TransformStamped
from numpy.lib.recfunctions import structured_to_unstructured
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Header

from labkit.errors import LabError
from labkit.transforms.buffer_interface import ConvertRegistration, TransformRegistration
from labkit.transforms.point_cloud2 import create_cloud, read_points
from labkit.transforms.tf2_geometry_msgs import as_matrix, from_msg_msg, to_msg_msg

__all__ = ['do_transform_cloud', 'from_msg_msg', 'to_msg_msg', 'transform_points']


def transform_points(point_cloud: NDArray[Any], transform: Transform) -> NDArray[np.float64]:
    """Return points in the frame to which a transform leads.

    Args:
        point_cloud: Points, a row of x, y and z for each.
        transform: The transform.
    """
    shift = transform.translation
    turned = point_cloud @ np.array(as_matrix(transform.rotation)).T
    return np.asarray(turned + np.array((shift.x, shift.y, shift.z)))


def do_transform_cloud(cloud: PointCloud2, transform: Transform | TransformStamped) -> PointCloud2:
    """Return a cloud as it is in the frame to which a transform leads.

    Raises:
        LabError: The cloud has no x, y and z.
    """
    header = Header(stamp=cloud.header.stamp, frame_id=cloud.header.frame_id)
    if isinstance(transform, TransformStamped):
        header.frame_id, transform = transform.header.frame_id, transform.transform
    known = [field.name for field in cloud.fields]
    if not {*'xyz'} <= {*known}:
        raise LabError(f'Only a cloud with x, y and z has a place, but this has {known}.')
    points = read_points(cloud).copy()
    moved = transform_points(structured_to_unstructured(points[['x', 'y', 'z']]), transform)
    for name, column in zip('xyz', moved.T, strict=True):
        points[name] = column
    return create_cloud(header, cloud.fields, points, cloud.point_step)


TransformRegistration().add(PointCloud2, do_transform_cloud)
ConvertRegistration().add_to_msg(PointCloud2, to_msg_msg)
ConvertRegistration().add_from_msg(PointCloud2, from_msg_msg)
