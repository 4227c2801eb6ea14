"""Messages whose content can't be meant, looked at where this process publishes them.

Only a sample is looked at, see `labkit.asking.traffic`, and only fields of types that are known.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator
from operator import attrgetter
from typing import Any

from labkit.silent.kinds import Fault, Kind, kind
from labkit.silent.scene import Scene

__all__ = ['NO_STAMP', 'SLASH_FRAME', 'checks_of', 'frame_of', 'look_at_messages', 'stamp_of']

_OTHERS = 'tf2 and RViz complain, if they are there'

ZERO_QUATERNION = kind(
    'messages.quaternion-zero',
    'The orientation is a quaternion of zeros',
    'The identity is w = 1, as in a new Quaternion().',
    'the orientation of an Imu is marked as unknown (covariance[0] = -1)',
    others=_OTHERS,
)
LONG_QUATERNION = kind(
    'messages.quaternion-length',
    'The orientation is no rotation: the quaternion does not have length 1',
    'Divide it by its length. x, y and z are no angles: yaw alone is z = sin(yaw / 2), '
    'w = cos(yaw / 2).',
    'its length is 1 to a hundredth',
    others=_OTHERS,
)
NAN = kind(
    'messages.nan',
    'A pose, a velocity or a point has a value that is not a number',
    'Look where it comes from: 0 / 0, a square root or acos of a rounded value, a field of a '
    'sensor that has seen nothing.',
    'ranges of a laser scan, where it has a meaning',
)
INFINITE = kind(
    'messages.infinite',
    'A pose, a velocity or a point has an infinite value',
    'Look for a division by zero, or for a range of a sensor that has seen nothing.',
    'ranges of a laser scan, where it has a meaning',
)
NO_FRAME = kind(
    'messages.frame-empty',
    'RViz shows nothing: frame_id in the header is empty',
    "Set it: message.header.frame_id = 'base_link'.",
    'types for which no frame is needed, such as JointState',
    others=_OTHERS,
)
SLASH_FRAME = kind(
    'messages.frame-slash',
    'tf2 does not know the frame: frame_id begins with a slash',
    'Leave the slash away: since tf2, frames have none.',
    'the slash is inside of the name',
    others=_OTHERS,
)
NO_STAMP = kind(
    'messages.stamp-zero',
    'Sensor data is dropped: the stamp in the header is 0',
    'Set it: message.header.stamp = self.get_clock().now().to_msg().',
    'types where 0 means the newest, such as a PoseStamped or a Marker; simulated time',
    others=_OTHERS,
)
DEGREES = kind(
    'messages.degrees',
    'The robot spins wildly, the scan is wrapped: degrees instead of radians',
    'ROS has radians everywhere: math.radians(90).',
    'the angle is less than a turn, the velocity less than three turns a second',
    guess='the value is larger than any that makes sense in radians',
)
MILLIMETRES = kind(
    'messages.millimetres',
    'Everything is a thousand times too large: millimetres instead of metres',
    'ROS has metres everywhere: divide by 1000.',
    'lengths as robots have them',
    guess='the value is larger than any that makes sense in metres',
)
PERCENT = kind(
    'messages.percent',
    'The battery shows 8000 %: percentage is a fraction, from 0 to 1',
    'Divide it by 100.',
    'it is a fraction, or unknown (NaN)',
)
LATITUDE = kind(
    'messages.latitude',
    'The position is on another continent: latitude and longitude are swapped',
    'A latitude is between -90 and 90 degrees; a longitude between -180 and 180.',
    'both are in their ranges',
)
IMAGE_SIZE = kind(
    'messages.image-size',
    'The image is not shown: the length of its data is not step * height',
    'step is the length of a row in bytes, data has height of them.',
    'the length fits',
    others='image viewers complain',
)
IMAGE_STEP = kind(
    'messages.image-encoding',
    'The image is garbled: its encoding does not fit its row length',
    'step is width times the bytes of one pixel: 1 for mono8, 3 for rgb8 and bgr8, 4 for rgba8.',
    'rows that are padded',
    others='image viewers complain',
)
SCAN_COUNT = kind(
    'messages.scan-count',
    'The laser scan is turned or squeezed: the number of ranges does not fit its angles',
    'There are (angle_max - angle_min) / angle_increment + 1 ranges.',
    'one range more or less: both are usual for a full turn',
)
SCAN_RANGE = kind(
    'messages.scan-range',
    'All ranges of the laser scan are ignored: range_max is not above range_min',
    'Set range_min and range_max: what is outside of them is no measurement.',
    'range_max is above range_min',
)
INTENSITIES = kind(
    'messages.intensities',
    'The laser scan has another number of intensities than of ranges',
    'Give one intensity for each range, or none at all.',
    'there are none',
)
GRID_SIZE = kind(
    'messages.grid-size',
    'The map is not shown: the length of its data is not width * height',
    'Put info.width * info.height values into data, row by row.',
    'the length fits',
    others='RViz complains',
)
GRID_SCALE = kind(
    'messages.grid-resolution',
    'The map is a point: its resolution is 0',
    'Set info.resolution: metres a cell.',
    'it is above 0',
)
CLOUD_SIZE = kind(
    'messages.cloud-size',
    'The point cloud is not shown: the length of its data is not row_step * height',
    'row_step is width * point_step, data has height rows.',
    'the length fits',
    others='RViz complains',
)
JOINTS = kind(
    'messages.joints',
    'Joints do not move: there are not as many positions as names',
    'Give one position for each name, in the same order. Velocities and efforts may be missing.',
    'there are positions for all, or none at all',
)
POINTS = kind(
    'messages.trajectory',
    'The trajectory is refused: a point has another number of positions than there are joints',
    'Give each point one position for each of joint_names, in the same order.',
    'all points have them',
    others='controllers complain',
)
POINT_TIMES = kind(
    'messages.trajectory-times',
    'The trajectory is refused or jumps: time_from_start does not grow',
    'Give each point a later time_from_start than the one before.',
    'it grows from point to point',
    others='controllers complain',
)
INVISIBLE = kind(
    'messages.marker-invisible',
    'RViz shows no marker: alpha of its colour is 0',
    'Set color.a = 1.0: it is 0 in a new Marker().',
    'the marker has colours for its points, or deletes one',
)
FLAT = kind(
    'messages.marker-scale',
    'RViz shows no marker: its scale is 0',
    'Set scale.x, scale.y and scale.z in metres: they are 0 in a new Marker().',
    'types that need no scale, or the marker deletes one',
    others='RViz warns',
)
COLOUR = kind(
    'messages.colour',
    'The colour is white or wrong: values from 0 to 255 instead of 0 to 1',
    'Divide them by 255.',
    'they are from 0 to 1',
)

Check = Callable[[Any], Iterator[tuple[Kind, str]]]

# Angles and velocities beyond which radians can't be meant: a turn, three turns a second.
_TURN, _TURNS_A_SECOND = 2 * math.pi + 0.01, 6 * math.pi
# A speed that no robot has, m/s, and a range that no laser of a robot has, m.
_SPEED, _RANGE = 50.0, 1000.0
_BYTES = {
    **{'mono8': 1, '8UC1': 1, 'mono16': 2, '16UC1': 2, '32FC1': 4},
    **{'rgb8': 3, 'bgr8': 3, '8UC3': 3, 'rgba8': 4, 'bgra8': 4},
}
_NEEDS_FRAME = {
    *('LaserScan', 'PointCloud2', 'PoseStamped', 'PoseArray', 'Path', 'Odometry', 'OccupancyGrid'),
    *('Imu', 'Range', 'Marker', 'TransformStamped', 'PointStamped', 'PoseWithCovarianceStamped'),
}
_NEEDS_STAMP = {
    *('LaserScan', 'PointCloud2', 'Odometry', 'Imu', 'Range', 'JointState', 'TransformStamped'),
}
_GEOMETRY = {'Vector3', 'Point', 'Point32', 'Quaternion', 'Pose2D'}
_DEEP = 4


def look_at_messages(scene: Scene) -> Iterator[Fault]:
    """Tell what is odd about the last messages."""
    from labkit.silent.kinds import KINDS

    for node in scene.nodes:
        for pub in node.publishers:
            for id, words in pub.found.items():
                if id == NO_STAMP.id and (node.sim_time or node.makes_clock):
                    continue
                yield Fault(
                    KINDS[id],
                    (node.name,),
                    pub.topic,
                    f'{node.name} publishes on {pub.topic} ({pub.msg_type.rpartition("/")[2]}): '
                    f'{words}.',
                )


@functools.lru_cache(maxsize=256)
def checks_of(msg_type: type) -> tuple[Check, ...]:
    """Return what to look at in messages of a type; nothing for most types."""
    name = msg_type.__name__
    found = [_OF_TYPE[name]] if name in _OF_TYPE else []
    for path, inner in _inner(msg_type):
        take = attrgetter(path) if path else _itself
        where = path or 'it'
        if path == 'header':
            found.append(functools.partial(_header, take, name))
        elif inner in _GEOMETRY:
            found.append(functools.partial(_numbers, take, where))
        if inner == 'Quaternion':
            found.append(functools.partial(_quaternion, take, where, name))
        elif inner == 'Twist':
            found.append(functools.partial(_twist, take))
        elif inner == 'ColorRGBA':
            found.append(functools.partial(_colour, take))
    return tuple(found)


@functools.lru_cache(maxsize=256)
def stamp_of(msg_type: type) -> Callable[[Any], int] | None:
    """Return a function that takes the stamp, ns, from messages of a type; None without stamp."""
    kinds = dict(msg_type.get_fields_and_field_types())  # type: ignore[attr-defined]
    if kinds.get('header') != 'std_msgs/Header':
        return None
    return lambda message: message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def frame_of(message: Any) -> str:
    """Return the frame in which a message is given; '' if it has none, or needs none."""
    return message.header.frame_id if type(message).__name__ in _NEEDS_FRAME else ''


def _itself(message: Any) -> Any:
    return message


def _inner(msg_type: Any, start: str = '', depth: int = 0) -> Iterator[tuple[str, str]]:
    """Yield the path and the name of each message in a message, itself included; no arrays."""
    yield start, msg_type.__name__
    if depth == _DEEP:
        return
    kinds = msg_type.get_fields_and_field_types()
    for (field, kind_name), slot in zip(kinds.items(), msg_type.SLOT_TYPES, strict=True):
        if '/' in kind_name and not kind_name.endswith(']') and '<' not in kind_name:
            inner = _class_of(slot)
            if inner is not None:
                yield from _inner(inner, f'{start}.{field}' if start else field, depth + 1)


def _class_of(slot: Any) -> Any:
    import importlib

    try:
        return getattr(importlib.import_module('.'.join(slot.namespaces)), slot.name)
    except (ImportError, AttributeError):
        return None


def _header(take: Any, name: str, message: Any) -> Iterator[tuple[Kind, str]]:
    header = take(message)
    if not header.frame_id and name in _NEEDS_FRAME:
        yield NO_FRAME, 'frame_id in its header is empty'
    if header.frame_id.startswith('/'):
        yield SLASH_FRAME, f'frame_id is {header.frame_id[:40]!r}, with a slash in front'
    if name in _NEEDS_STAMP and not (header.stamp.sec or header.stamp.nanosec):
        yield NO_STAMP, 'the stamp in its header is 0'


def _numbers(take: Any, where: str, message: Any) -> Iterator[tuple[Kind, str]]:
    part = take(message)
    for name in part.get_fields_and_field_types():
        value = getattr(part, name)
        if value != value:
            yield NAN, f'{name} of {where} is not a number'
            return
        if value in (math.inf, -math.inf):
            yield INFINITE, f'{name} of {where} is {value}'
            return


def _quaternion(take: Any, where: str, name: str, message: Any) -> Iterator[tuple[Kind, str]]:
    if name == 'Imu' and message.orientation_covariance[0] == -1:
        return
    q = take(message)
    length = math.sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w)
    if length == 0:
        yield ZERO_QUATERNION, f'{where} is (0, 0, 0, 0), which is no orientation'
    elif abs(length - 1) > 0.01:
        yield LONG_QUATERNION, f'the length of {where} is {length:.3g} instead of 1'


def _twist(take: Any, message: Any) -> Iterator[tuple[Kind, str]]:
    twist = take(message)
    turn, speed = twist.angular.z, twist.linear.x
    if _TURNS_A_SECOND < abs(turn) < math.inf:
        yield DEGREES, f'angular.z is {turn:g}, {abs(turn) / math.tau:.1f} turns a second'
    if _SPEED < abs(speed) < math.inf:
        yield MILLIMETRES, f'linear.x is {speed:g} m/s'


def _colour(take: Any, message: Any) -> Iterator[tuple[Kind, str]]:
    colour = take(message)
    most = max(colour.r, colour.g, colour.b, colour.a)
    if most > 1:
        yield COLOUR, f'its colour has the value {most:g}, the largest is 1'


def _scan(scan: Any) -> Iterator[tuple[Kind, str]]:
    widest = max(abs(scan.angle_min), abs(scan.angle_max))
    count = len(scan.ranges)
    if widest > _TURN:
        yield DEGREES, f'its angles go up to {widest:g}'
    if scan.range_max <= scan.range_min:
        yield SCAN_RANGE, f'range_min is {scan.range_min:g}, range_max {scan.range_max:g}'
    elif _RANGE <= scan.range_max < math.inf:
        yield MILLIMETRES, f'range_max is {scan.range_max:g} m'
    if scan.angle_increment and count:
        expected = (scan.angle_max - scan.angle_min) / scan.angle_increment + 1
        # Angles are rounded to 7 digits, which many small steps add up.
        if abs(expected - count) > 1.5:
            yield SCAN_COUNT, f'it has {count} ranges, its angles are for {expected:.0f}'
    if scan.intensities and len(scan.intensities) != count:
        yield INTENSITIES, f'it has {count} ranges and {len(scan.intensities)} intensities'


def _image(image: Any) -> Iterator[tuple[Kind, str]]:
    if len(image.data) != image.step * image.height:
        yield (
            IMAGE_SIZE,
            f'it has {len(image.data)} bytes, but step * height is {image.step * image.height}',
        )
    size = _BYTES.get(image.encoding, 0) * image.width
    if size and image.step < size:
        yield (
            IMAGE_STEP,
            f'a row of {image.width} pixels as {image.encoding} needs {size} bytes, and has '
            f'{image.step}',
        )


def _grid(grid: Any) -> Iterator[tuple[Kind, str]]:
    info, count = grid.info, len(grid.data)
    if count != info.width * info.height:
        yield GRID_SIZE, f'it has {count} values for {info.width} * {info.height} cells'
    if info.resolution <= 0:
        yield GRID_SCALE, f'its resolution is {info.resolution:g}'


def _cloud(cloud: Any) -> Iterator[tuple[Kind, str]]:
    size = cloud.row_step * cloud.height
    if len(cloud.data) != size:
        yield CLOUD_SIZE, f'it has {len(cloud.data)} bytes, but row_step * height is {size}'


def _joints(joints: Any) -> Iterator[tuple[Kind, str]]:
    names, positions = len(joints.name), joints.position
    if len(positions) not in (0, names):
        yield JOINTS, f'it has {names} names and {len(positions)} positions'
    large = [p for p in positions[:50] if abs(p) > 2 * _TURN]
    if (
        large
        and all(p == int(p) for p in large if abs(p) < math.inf)
        and max(map(abs, large)) <= 360
    ):
        yield DEGREES, f'a position is {large[0]:g}, a whole number'


def _trajectory(trajectory: Any) -> Iterator[tuple[Kind, str]]:
    names, before = len(trajectory.joint_names), -1
    for number, point in enumerate(trajectory.points[:100], 1):
        if len(point.positions) != names:
            yield POINTS, f'point {number} has {len(point.positions)} positions for {names} joints'
            return
        time = point.time_from_start.sec * 10**9 + point.time_from_start.nanosec
        if time <= before:
            yield POINT_TIMES, f'time_from_start of point {number} is not after the one before'
            return
        before = time


def _marker(marker: Any) -> Iterator[tuple[Kind, str]]:
    if marker.action != marker.ADD:
        return
    if not marker.color.a and not marker.colors and not marker.mesh_use_embedded_materials:
        yield INVISIBLE, 'alpha of its colour is 0'
    if marker.type in (marker.CUBE, marker.SPHERE, marker.CYLINDER, marker.ARROW) and not (
        marker.scale.x and marker.scale.y
    ):
        yield FLAT, 'its scale is 0'


def _battery(battery: Any) -> Iterator[tuple[Kind, str]]:
    if battery.percentage > 1:
        yield PERCENT, f'percentage is {battery.percentage:g}'


def _fix(fix: Any) -> Iterator[tuple[Kind, str]]:
    if abs(fix.latitude) > 90:
        yield LATITUDE, f'its latitude is {fix.latitude:g}'


_OF_TYPE: dict[str, Check] = {
    'LaserScan': _scan,
    'Image': _image,
    'OccupancyGrid': _grid,
    'PointCloud2': _cloud,
    'JointState': _joints,
    'JointTrajectory': _trajectory,
    'Marker': _marker,
    'BatteryState': _battery,
    'NavSatFix': _fix,
}
