"""One number out of a serialized message is what the whole message has there."""

from __future__ import annotations

import math
import random
from operator import attrgetter, itemgetter
from typing import Any

import pytest
from rclpy.serialization import serialize_message

from labkit.rosgraph.interfaces import message_class
from labkit.rosgraph.serialized import number_reader
from labkit.views.plot_fields import Source, number_paths, parse, reader

TYPES = [
    'geometry_msgs/msg/PoseWithCovarianceStamped',
    'geometry_msgs/msg/Polygon',
    'nav_msgs/msg/OccupancyGrid',
    'nav_msgs/msg/Odometry',
    'nav_msgs/msg/Path',
    'sensor_msgs/msg/BatteryState',
    'sensor_msgs/msg/Imu',
    'sensor_msgs/msg/JointState',
    'sensor_msgs/msg/LaserScan',
    'sensor_msgs/msg/PointCloud2',
    'sensor_msgs/msg/MultiDOFJointState',
    'std_msgs/msg/Int16',
    'std_msgs/msg/Float64MultiArray',
    'test_msgs/msg/Arrays',
    'test_msgs/msg/BasicTypes',
    'test_msgs/msg/BoundedSequences',
    'test_msgs/msg/MultiNested',
    'test_msgs/msg/Nested',
    'test_msgs/msg/UnboundedSequences',
    'trajectory_msgs/msg/JointTrajectory',
]
LIMITS = {'boolean': (0, 1), 'octet': (0, 255), 'char': (0, 255)}


def drawn(slot: Any, dice: random.Random) -> Any:
    """Return a value of a type."""
    if hasattr(slot, 'value_type'):
        most = min(getattr(slot, 'maximum_size', 3), 3)
        count = getattr(slot, 'size', None) or dice.randint(0, most)
        return [drawn(slot.value_type, dice) for _ in range(count)]
    if hasattr(slot, 'namespaced_name'):
        return filled(message_class('/'.join(slot.namespaced_name())), dice)
    name = getattr(slot, 'typename', 'string')
    if name == 'string':
        return ''.join(dice.choice('aü漢') for _ in range(dice.randint(0, 5)))
    if name in ('float', 'double'):
        return float(dice.randint(-(2**20), 2**20))
    if name == 'boolean':
        return dice.random() < 0.5
    if name == 'octet':
        return bytes([dice.randint(0, 255)])
    if name in LIMITS:
        return dice.randint(*LIMITS[name])
    bits = int(name.lstrip('uint'))
    low = 0 if name.startswith('u') else -(2 ** (bits - 1))
    return dice.randint(low, low + 2**bits - 1)


def filled(msg_type: Any, dice: random.Random) -> Any:
    """Return a message with values that are drawn, and arrays of all lengths up to 3."""
    message = msg_type()
    names = msg_type.get_fields_and_field_types()
    for name, slot in zip(names, msg_type.SLOT_TYPES, strict=True):
        setattr(message, name, drawn(slot, dice))
    return message


def seen(message: Any, path: str) -> Any:
    """Return a field of a message; 'short' if an array has no such element."""
    for part in path.split('.'):
        name, _, index = part.partition('[')
        message = attrgetter(name)(message)
        if index:
            try:
                message = itemgetter(int(index[:-1]))(message)
            except IndexError:
                return 'short'
    return message


@pytest.mark.parametrize(
    'name',
    [
        pytest.param(name, marks=pytest.mark.slow('thousands of numbers'))
        if name.endswith('/MultiNested')
        else name
        for name in TYPES
    ],
)
def test_each_number_is_read_as_it_is_in_the_message(name: str) -> None:
    msg_type, dice = message_class(name), random.Random(name)
    paths = list(number_paths(msg_type))
    paths += [path.replace('[0]', '[1]') for path in paths if '[0]' in path]
    readers = {path: reader(Source(path, 'topic', path), msg_type) for path in paths}
    compared = 0
    for _ in range(20):
        message = filled(msg_type, dice)
        data = serialize_message(message)
        for path, read in readers.items():
            wanted = seen(message, path)
            try:
                found = read(data)
            except IndexError:
                found = 'short'
            assert found == wanted, path
            compared += 1
    assert compared >= 20


def made(data: bytes) -> Any:
    raise AssertionError('the whole message was made')


def test_no_message_is_made_for_it() -> None:
    msg_type = message_class('nav_msgs/msg/Odometry')
    message = msg_type()
    message.header.frame_id, message.twist.twist.angular.z = 'odom', -1.5
    path: list[tuple[str, int | None]] = [
        ('twist', None),
        ('twist', None),
        ('angular', None),
        ('z', None),
    ]
    assert number_reader(msg_type, path, made)(serialize_message(message)) == -1.5


def test_a_way_past_a_type_of_unknown_size_and_another_order_of_bytes() -> None:
    texts = message_class('test_msgs/msg/WStrings')
    assert number_reader(texts, [('wstring_value', None)], len) is len
    number = message_class('std_msgs/msg/Float64')
    read = number_reader(number, [('data', None)], lambda data: math.nan)
    assert math.isnan(read(b'\x00\x00\x00\x00' + bytes(8)))


def test_an_element_behind_the_end_of_an_array() -> None:
    msg_type = message_class('sensor_msgs/msg/LaserScan')
    read = reader(parse('/scan.ranges[2]'), msg_type)
    assert read(serialize_message(msg_type(ranges=[1.0, 2.0, 3.0]))) == 3.0
    with pytest.raises(IndexError):
        read(serialize_message(msg_type(ranges=[1.0, 2.0])))
