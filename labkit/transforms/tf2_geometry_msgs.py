"""Messages of geometry_msgs in another frame.

Results are those of the real functions (ros2/geometry2, branch jazzy,
tf2_geometry_msgs/src/tf2_geometry_msgs/tf2_geometry_msgs.py), and the header is the transform's.
A quaternion of any length is taken for that of length 1; one of length 0 does not turn.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from geometry_msgs.msg import (
    Point32,
    PointStamped,
    PolygonStamped,
    Pose,
    PoseStamped,
    PoseWithCovarianceStamped,
    TransformStamped,
    Vector3Stamped,
)
from numpy.typing import NDArray
from std_msgs.msg import Header

from labkit.transforms.buffer_interface import ConvertRegistration, TransformRegistration
from labkit.transforms.rotations import Matrix, Quaternion, Vector, matrix, normalized, product

__all__ = [
    'do_transform_point',
    'do_transform_polygon_stamped',
    'do_transform_pose',
    'do_transform_pose_stamped',
    'do_transform_pose_with_covariance_stamped',
    'do_transform_vector3',
    'from_msg_msg',
    'to_msg_msg',
    'transform_covariance',
]

_UNTURNED: Quaternion = (0.0, 0.0, 0.0, 1.0)
_EPSILON = float(np.finfo(np.float64).eps)


def do_transform_point(point: PointStamped, transform: TransformStamped) -> PointStamped:
    """Return a point as it is in the frame to which a transform leads."""
    found = PointStamped(header=_header(transform))
    found.point.x, found.point.y, found.point.z = _moved(_parts(point.point), transform)
    return found


def do_transform_vector3(vector3: Vector3Stamped, transform: TransformStamped) -> Vector3Stamped:
    """Return a vector, which has no place, as it is in the frame to which a transform leads."""
    found = Vector3Stamped(header=_header(transform))
    turned = _applied(_turn(transform), _parts(vector3.vector))
    found.vector.x, found.vector.y, found.vector.z = turned
    return found


def do_transform_pose(pose: Pose, transform: TransformStamped) -> Pose:
    """Return a pose as it is in the frame to which a transform leads."""
    found = Pose()
    place, turn = found.position, found.orientation
    place.x, place.y, place.z = _moved(_parts(pose.position), transform)
    turned = product(_unit(transform.transform.rotation), _unit(pose.orientation))
    # Of the two quaternions of a rotation, the real one returns that with w above 0.
    sign = -1.0 if turned[3] < 0 else 1.0
    turn.x, turn.y, turn.z, turn.w = (sign * part for part in turned)
    return found


def do_transform_pose_stamped(pose: PoseStamped, transform: TransformStamped) -> PoseStamped:
    """Return a pose as it is in the frame to which a transform leads."""
    return PoseStamped(header=_header(transform), pose=do_transform_pose(pose.pose, transform))


def do_transform_pose_with_covariance_stamped(
    pose: PoseWithCovarianceStamped, transform: TransformStamped
) -> PoseWithCovarianceStamped:
    """Return a pose and its covariance as they are in the frame to which a transform leads."""
    found = PoseWithCovarianceStamped(header=_header(transform))
    found.pose.pose = do_transform_pose(pose.pose.pose, transform)
    found.pose.covariance = transform_covariance(pose.pose.covariance, transform)
    return found


def do_transform_polygon_stamped(
    polygon: PolygonStamped, transform: TransformStamped
) -> PolygonStamped:
    """Return a polygon as it is in the frame to which a transform leads."""
    found = PolygonStamped(header=_header(transform))
    for corner in polygon.polygon.points:
        x, y, z = _moved(_parts(corner), transform)
        found.polygon.points.append(Point32(x=x, y=y, z=z))
    return found


def transform_covariance(cov_in: Any, transform: TransformStamped) -> NDArray[np.float64]:
    """Return a covariance of x, y, z, roll, pitch and yaw, 36 numbers, in another frame.

    The covariance of R x is R C Rᵀ (A. L. Garcia, "Probability, Statistics, and Random Processes
    For Electrical Engineering", 3rd ed., p. 318), for places and for angles.
    """
    turns = np.kron(np.eye(2), np.array(_turn(transform)))
    covariance = np.asarray(cov_in, dtype=np.float64).reshape(6, 6)
    return np.asarray(turns @ covariance @ turns.T).ravel()


def to_msg_msg(msg: Any) -> Any:
    """Return a message: it is one already."""
    return msg


from_msg_msg = to_msg_msg

for _type, _function in (
    (PointStamped, do_transform_point),
    (Vector3Stamped, do_transform_vector3),
    (PoseStamped, do_transform_pose_stamped),
    (PoseWithCovarianceStamped, do_transform_pose_with_covariance_stamped),
    (PolygonStamped, do_transform_polygon_stamped),
):
    TransformRegistration().add(_type, _function)
for _type in (Vector3Stamped, PoseStamped, PointStamped):
    ConvertRegistration().add_to_msg(_type, to_msg_msg)
    ConvertRegistration().add_from_msg(_type, from_msg_msg)


def _header(transform: TransformStamped) -> Header:
    return Header(stamp=transform.header.stamp, frame_id=transform.header.frame_id)


def _parts(message: Any) -> Vector:
    return message.x, message.y, message.z


def _unit(rotation: Any) -> Quaternion:
    q = (rotation.x, rotation.y, rotation.z, rotation.w)
    if sum(part * part for part in q) < _EPSILON:
        return _UNTURNED
    return normalized(matrix(q))


def as_matrix(rotation: Any) -> Matrix:
    """Return the matrix of the message of a quaternion."""
    return matrix(_unit(rotation))


def _turn(transform: TransformStamped) -> Matrix:
    return as_matrix(transform.transform.rotation)


def _applied(m: Matrix, v: Vector) -> Vector:
    x, y, z = (row[0] * v[0] + row[1] * v[1] + row[2] * v[2] for row in m)
    return x, y, z


def _moved(point: Vector, transform: TransformStamped) -> Vector:
    x, y, z = _applied(_turn(transform), point)
    shift = transform.transform.translation
    return x + shift.x, y + shift.y, z + shift.z
