"""Fields for `lab.plot`: numbers in messages, and their units.

A field is written as the topic, a dot, and the path in the message: `/scan.ranges[0]`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from operator import attrgetter, itemgetter
from typing import Any

from labkit.errors import LabError, nearest, quoted
from labkit.rosgraph.interfaces import slot_class, slots, type_name
from labkit.rosgraph.serialized import number_reader

__all__ = ['Source', 'number_paths', 'parse', 'reader', 'resolve', 'unit_of']

_PART = re.compile(r'(?P<name>[A-Za-z]\w*)(?:\[(?P<index>\d{1,9})\])?')
# Basic types of interface files that are not numbers.
_NO_NUMBERS = ('octet', 'wchar')

_MOTION = {'linear': 'm/s', 'angular': 'rad/s'}
_ACCELERATION = {'linear': 'm/s²', 'angular': 'rad/s²'}
# Units of fields and everything in them, by type and name. Sources: REP 103, and the comments in
# the
# message files.
UNITS = {
    'builtin_interfaces/msg/Time': {'sec': 's', 'nanosec': 'ns'},
    'builtin_interfaces/msg/Duration': {'sec': 's', 'nanosec': 'ns'},
    'geometry_msgs/msg/Accel': _ACCELERATION,
    'geometry_msgs/msg/Point': {'x': 'm', 'y': 'm', 'z': 'm'},
    'geometry_msgs/msg/Point32': {'x': 'm', 'y': 'm', 'z': 'm'},
    'geometry_msgs/msg/Pose': {'position': 'm'},
    'geometry_msgs/msg/Pose2D': {'x': 'm', 'y': 'm', 'theta': 'rad'},
    'geometry_msgs/msg/Transform': {'translation': 'm'},
    'geometry_msgs/msg/Twist': _MOTION,
    'geometry_msgs/msg/Wrench': {'force': 'N', 'torque': 'N·m'},
    'nav_msgs/msg/MapMetaData': {'resolution': 'm'},
    'sensor_msgs/msg/BatteryState': {
        'voltage': 'V',
        'cell_voltage': 'V',
        'temperature': '°C',
        'cell_temperature': '°C',
        'current': 'A',
        'charge': 'Ah',
        'capacity': 'Ah',
        'design_capacity': 'Ah',
    },
    'sensor_msgs/msg/FluidPressure': {'fluid_pressure': 'Pa', 'variance': 'Pa²'},
    'sensor_msgs/msg/Illuminance': {'illuminance': 'lx', 'variance': 'lx²'},
    'sensor_msgs/msg/Imu': {'angular_velocity': 'rad/s', 'linear_acceleration': 'm/s²'},
    # The position of a prismatic joint is in metres.
    'sensor_msgs/msg/JointState': {'position': 'rad or m'},
    'sensor_msgs/msg/LaserScan': {
        **dict.fromkeys(('angle_min', 'angle_max', 'angle_increment'), 'rad'),
        **dict.fromkeys(('time_increment', 'scan_time'), 's'),
        **dict.fromkeys(('range_min', 'range_max', 'ranges'), 'm'),
    },
    'sensor_msgs/msg/MagneticField': {'magnetic_field': 'T'},
    'sensor_msgs/msg/NavSatFix': {'latitude': '°', 'longitude': '°', 'altitude': 'm'},
    'sensor_msgs/msg/Range': {
        'field_of_view': 'rad',
        'variance': 'm²',
        **dict.fromkeys(('min_range', 'max_range', 'range'), 'm'),
    },
    'sensor_msgs/msg/Temperature': {'temperature': '°C', 'variance': '°C²'},
    'trajectory_msgs/msg/JointTrajectoryPoint': {'positions': 'rad or m'},
}


@dataclass(frozen=True)
class Source:
    """A field to plot.

    Attributes:
        text: The field as written.
        topic: The topic as written.
        path: The path of the field in a message.
    """

    text: str
    topic: str
    path: str


def parse(text: object) -> Source:
    """Parse a field such as `'/odom.pose.pose.position.x'`.

    Raises:
        LabError: The syntax is wrong.
    """
    if not isinstance(text, str):
        raise LabError(
            f'A field must be a text, but it is {quoted(text)}.',
            todo="Write the topic, a dot and the field: '/odom.pose.pose.position.x'",
        )
    topic, _, path = text.strip().partition('.')
    if topic and not path:
        raise LabError(
            f'{quoted(text)} names a topic, but no field of its messages.',
            todo=f"Add a dot and the field, such as '{topic}.data'. "
            'ros2 interface show tells the fields of a type.',
        )
    if not topic or not all(_PART.fullmatch(word) for word in path.split('.')):
        raise LabError(
            f'{quoted(text)} names no field of a message.',
            todo="Write the topic, a dot and the field: '/odom.pose.pose.position.x' or "
            "'/scan.ranges[0]'",
        )
    return Source(text.strip(), topic, path)


def resolve(source: Source, msg_type: Any) -> Callable[[Any], Any]:
    """Return a function that reads the field of a message.

    Raises:
        LabError: There is no such field, or it is not a number. Suggests a similar one.
    """
    getters: list[Callable[[Any], Any]] = []
    slot: Any = None
    inner: Any = msg_type
    words = [found.groupdict() for found in _PART.finditer(source.path)]
    for word in words:
        fields = slots(inner) if inner is not None else {}
        if word['name'] not in fields:
            raise LabError(
                f'{quoted(source.text)}: {type_name(msg_type)} has no field '
                f'{quoted(source.path)}.',
                todo=_near(source, msg_type),
            )
        slot = fields[word['name']]
        getters.append(attrgetter(word['name']))
        if word['index'] is not None:
            if not hasattr(slot, 'value_type'):
                raise _no_number(source, msg_type, 'no array, so it has no [...]')
            _check_index(source, slot, int(word['index']))
            slot = slot.value_type
            getters.append(itemgetter(int(word['index'])))
        inner = slot_class(slot)
    what = _why_no_number(slot, inner)
    if what:
        raise _no_number(source, msg_type, what)
    return _joined(words, getters)


def reader(source: Source, msg_type: Any) -> Callable[[bytes], Any]:
    """Return a function that reads the field of a serialized message.

    Raises:
        LabError: As `resolve` does.
    """
    from rclpy.serialization import deserialize_message

    get = resolve(source, msg_type)
    path = [
        (found['name'], int(found['index']) if found['index'] is not None else None)
        for found in _PART.finditer(source.path)
    ]
    return number_reader(msg_type, path, lambda data: get(deserialize_message(data, msg_type)))


def number_paths(msg_type: Any, start: str = '') -> Iterator[str]:
    """Yield the paths of all numbers; of an array, that of its first element."""
    for name, field_slot in slots(msg_type).items():
        path, slot = f'{start}{name}', field_slot
        if hasattr(slot, 'value_type'):
            path, slot = f'{path}[0]', slot.value_type
        inner = slot_class(slot)
        if inner is not None:
            yield from number_paths(inner, f'{path}.')
        elif not _why_no_number(slot, None):
            yield path


def unit_of(path: str, msg_type: Any) -> str:
    """Return the unit of an existing field, '' if unknown."""
    inner = msg_type
    for found in _PART.finditer(path):
        unit = UNITS.get(type_name(inner), {}).get(found['name'], '')
        if unit:
            return unit
        slot = slots(inner)[found['name']]
        inner = slot_class(getattr(slot, 'value_type', slot))
        if inner is None:
            return ''
    return ''


def _why_no_number(slot: Any, inner: Any) -> str:
    if inner is not None:
        return f'a {type_name(inner)}'
    if hasattr(slot, 'value_type'):
        return 'an array'
    name = getattr(slot, 'typename', 'string')
    if name == 'string':
        return 'a text'
    return f'a {name}' if name in _NO_NUMBERS else ''


def _check_index(source: Source, slot: Any, index: int) -> None:
    size = getattr(slot, 'size', None) or getattr(slot, 'maximum_size', None)
    if size is not None and index >= size:
        raise LabError(
            f'{quoted(source.text)} asks for element {index}, but there are at most {size}.',
            todo=f'They are counted from 0: the last one is [{size - 1}].',
        )


def _joined(words: list[Any], getters: list[Callable[[Any], Any]]) -> Callable[[Any], Any]:
    # The usual case in one step: it runs for every message.
    if all(word['index'] is None for word in words):
        return attrgetter('.'.join(word['name'] for word in words))

    def get(message: Any) -> Any:
        for getter in getters:
            message = getter(message)
        return message

    return get


def _no_number(source: Source, msg_type: Any, what: str) -> LabError:
    return LabError(
        f'{quoted(source.text)} is {what}. Only numbers can be drawn.',
        todo=_near(source, msg_type),
    )


def _near(source: Source, msg_type: Any) -> str:
    """Return a suggestion of the intended field."""
    paths = list(number_paths(msg_type))
    inside = [p for p in paths if p.startswith(source.path)]
    ending = [p for p in paths if p.endswith(f'.{source.path}')]
    bare = re.sub(r'\[\d+\]', '', source.path)
    near = [*inside, *ending, *[p for p in paths if p == bare]][:1] or [
        nearest(source.path, paths)
    ]
    last = [p for p in paths if p.rpartition('.')[2] == source.path.rpartition('.')[2]]
    found = near[0] or (last[0] if last else '')
    if found:
        return f'Did you mean {f"{source.topic}.{found}"!r}?'
    if not paths:
        return f'{type_name(msg_type)} has no field that is a number.'
    paths.sort(key=lambda path: path.startswith('header.'))
    some = ', '.join(paths[:4]) + (' and more' if len(paths) > 4 else '')
    return f'Its numbers: {some}.'
