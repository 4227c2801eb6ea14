"""Steps with a buffer of tf2, and messages in another frame.

What the real one says to them is recorded, and ours has to say the same.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

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
from rclpy.duration import Duration
from rclpy.time import Time

__all__ = ['KINDS', 'ask', 'make_buffer', 'put', 'transformed']

# The arguments of each question that are times, ns.
TIMES = {
    'lookup_transform_core': (2,),
    'can_transform_core': (2,),
    'lookup_transform_full_core': (1, 3),
    'can_transform_full_core': (1, 3),
}
# Kinds of messages, and of how many numbers one is made.
KINDS = {
    'point': 3,
    'vector3': 3,
    'pose': 7,
    'pose_stamped': 7,
    'pose_with_covariance_stamped': 43,
    'polygon_stamped': 9,
}


def make_buffer(module: Any, cache_time: int | None) -> Any:
    """Return a new buffer of a module `tf2_py` that remembers so long, ns."""
    if cache_time is None:
        return module.BufferCore()
    return module.BufferCore(Duration(nanoseconds=cache_time))


def put(buffer: Any, step: dict[str, Any]) -> None:
    """Give a transform to a buffer, or clear it."""
    if 'clear' in step:
        buffer.clear()
        return
    transform = TransformStamped()
    transform.header.frame_id, transform.child_frame_id = step['parent'], step['child']
    transform.header.stamp = Time(nanoseconds=step['time']).to_msg()
    shift, turn = transform.transform.translation, transform.transform.rotation
    shift.x, shift.y, shift.z = map(float, step['shift'])
    turn.x, turn.y, turn.z, turn.w = map(float, step['turn'])
    setter = buffer.set_transform_static if step.get('static') else buffer.set_transform
    setter(transform, 'the test')


def ask(module: Any, buffer: Any, call: str, arguments: list[Any]) -> Any:
    """Ask a buffer, and return its answer as JSON has it."""
    times = TIMES.get(call, ())
    given = [
        Time(nanoseconds=value) if place in times else value
        for place, value in enumerate(arguments)
    ]
    try:
        answer = getattr(buffer, call)(*given)
    except module.TransformException as error:
        return {'error': type(error).__name__, 'words': str(error)}
    if isinstance(answer, TransformStamped):
        shift, turn = answer.transform.translation, answer.transform.rotation
        return {
            'target': answer.header.frame_id,
            'source': answer.child_frame_id,
            'time': Time.from_msg(answer.header.stamp).nanoseconds,
            'shift': [shift.x, shift.y, shift.z],
            'turn': [turn.x, turn.y, turn.z, turn.w],
        }
    if isinstance(answer, Time):
        return answer.nanoseconds
    return [bool(answer[0]), answer[1]] if isinstance(answer, tuple) else answer


def transformed(module: Any, case: dict[str, Any]) -> list[float]:
    """Return the numbers of a message that a module `tf2_geometry_msgs` has transformed."""
    kind, given = case['kind'], list(map(float, case['given']))
    transform = TransformStamped()
    transform.header.frame_id = 'odom'
    transform.header.stamp.sec = 7
    shift, turn = transform.transform.translation, transform.transform.rotation
    shift.x, shift.y, shift.z = map(float, case['shift'])
    turn.x, turn.y, turn.z, turn.w = map(float, case['turn'])
    message, parts = _message(kind, given)
    result = getattr(module, f'do_transform_{kind}')(message, transform)
    if kind != 'pose':
        assert (result.header.frame_id, result.header.stamp.sec) == ('odom', 7)
    return [float(number) for number in parts(result)]


def _message(kind: str, given: list[float]) -> tuple[Any, Callable[[Any], list[float]]]:
    """Return a message of some numbers, and what takes them out of one."""
    if kind == 'point':
        point = PointStamped()
        point.point.x, point.point.y, point.point.z = given
        return point, lambda one: _xyz(one.point)
    if kind == 'vector3':
        vector = Vector3Stamped()
        vector.vector.x, vector.vector.y, vector.vector.z = given
        return vector, lambda one: _xyz(one.vector)
    if kind == 'polygon_stamped':
        polygon = PolygonStamped()
        for first in range(0, len(given), 3):
            x, y, z = given[first : first + 3]
            polygon.polygon.points.append(Point32(x=x, y=y, z=z))
        return polygon, lambda one: [part for each in one.polygon.points for part in _xyz(each)]
    pose = Pose()
    pose.position.x, pose.position.y, pose.position.z, *given = given
    turn = pose.orientation
    turn.x, turn.y, turn.z, turn.w, *given = given
    if kind == 'pose':
        return pose, _pose_parts
    if kind == 'pose_stamped':
        return PoseStamped(pose=pose), lambda one: _pose_parts(one.pose)
    known = PoseWithCovarianceStamped()
    known.pose.pose, known.pose.covariance = pose, given
    return known, lambda one: [*_pose_parts(one.pose.pose), *one.pose.covariance]


def _xyz(one: Any) -> list[float]:
    return [one.x, one.y, one.z]


def _pose_parts(pose: Any) -> list[float]:
    return [*_xyz(pose.position), *_xyz(pose.orientation), pose.orientation.w]
