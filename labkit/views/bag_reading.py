"""Read the content of a bag's picture, never all of its messages at once.

Arrival times come from the bag's index. Contents are read message by message; of very many
messages, an evenly spaced sample.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np

from labkit.bags.reader import Bag, BagTopic
from labkit.errors import LabError, nearest, quoted
from labkit.rosgraph.interfaces import message_class
from labkit.rosgraph.refusals import Refused
from labkit.sim.kinematics import Pose
from labkit.views.message_tree import fields_of, is_message
from labkit.views.plot_fields import Source, resolve, unit_of
from labkit.views.plot_picture import Floats
from labkit.views.robot_messages import motion_of

__all__ = [
    'BINS',
    'ODOMETRY',
    'SCAN',
    'Content',
    'Samples',
    'Strip',
    'Track',
    'check_field',
    'chosen_topic',
    'number_paths',
    'read_samples',
    'read_strip',
    'read_track',
]

ODOMETRY, SCAN = 'nav_msgs/msg/Odometry', 'sensor_msgs/msg/LaserScan'
# Columns of a timeline.
BINS = 240
# Most messages read of a topic; of more, every n-th.
MAX_SAMPLES = 5000
# Most fields offered for drawing. Some types have thousands.
MAX_FIELDS = 200

Progress = Callable[[float], None]


@dataclass(frozen=True)
class Strip:
    """Arrival times of the messages of a topic.

    Attributes:
        first_sec: Time of the first message, s from the beginning of the bag.
        last_sec: Time of the last message, s from the beginning of the bag.
        gap: Length and start of the longest pause, s; None with fewer than two messages.
        bins: Number of messages in each column.
    """

    topic: BagTopic
    first_sec: float
    last_sec: float
    gap: tuple[float, float] | None
    bins: Any

    @property
    def rate(self) -> float | None:
        """The mean rate between the first and the last message, Hz."""
        took = self.last_sec - self.first_sec
        # The count is what the bag says; its messages may say otherwise.
        return (self.topic.count - 1) / took if self.topic.count > 1 and took > 0 else None


@dataclass(frozen=True)
class Samples:
    """The numbers of one field.

    Attributes:
        unit: Its unit, '' if unknown.
        times: Arrival times, s from the beginning of the bag.
        values: Values of the field.
        step: Every `step`-th message was read.
        problem: Why there is less than there should be, '' if nothing is missing.
    """

    source: Source
    unit: str
    times: Floats
    values: Floats
    step: int
    problem: str


@dataclass(frozen=True)
class Track:
    """The path of a robot.

    Attributes:
        topic: Topic of its odometry.
        times: Time of each pose, s from the beginning of the bag.
        numbers: x, y, yaw, v and w for each time.
    """

    topic: str
    times: Floats
    numbers: Any

    def pose_at(self, seconds: float) -> Pose | None:
        """Return the last pose at or before a time, None if there is none."""
        index = int(np.searchsorted(self.times, seconds, side='right')) - 1
        return None if index < 0 else Pose(*map(float, self.numbers[index, :3]))


@dataclass(frozen=True)
class Content:
    """The content of a bag's picture.

    Attributes:
        strips: Arrival times, by topic.
        samples: Numbers of the drawn fields.
        track: Path of a robot, if the bag has one.
        problems: What could not be read, as sentences.
    """

    strips: Sequence[Strip]
    samples: Sequence[Samples]
    track: Track | None
    problems: Sequence[str]


def read_strip(bag: Bag, topic: BagTopic) -> Strip:
    """Return the arrival times of the messages of a topic.

    Raises:
        LabError: The bag is damaged.
    """
    stamps = bag.stamps(topic.name)
    # Two types on one topic share a timeline.
    seconds = (stamps - bag.start_ns) / 1e9
    if not len(seconds):
        return Strip(topic, 0.0, 0.0, None, np.zeros(BINS, dtype=np.int64))
    bins, _ = np.histogram(seconds, BINS, (0.0, max(bag.duration_sec, 1e-9)))
    gap = None
    if len(seconds) > 1:
        # In whole nanoseconds: of equal pauses, take the first.
        pauses = np.diff(stamps)
        longest = int(np.argmax(pauses))
        gap = float(pauses[longest] / 1e9), float(seconds[longest])
    return Strip(topic, float(seconds[0]), float(seconds[-1]), gap, bins)


def chosen_topic(bag: Bag, wanted: str | None, msg_type: str, near: str = '') -> str:
    """Return the name of a topic of a type, '' if there is none.

    Args:
        bag: The bag.
        wanted: The requested topic; None for the one with the most messages, '' for none.
        msg_type: Its type.
        near: A topic of the same robot: prefer its namespace.

    Raises:
        LabError: The bag has no such topic, or it has another type.
    """
    if wanted == '':
        return ''
    if wanted is not None:
        topic = bag.topic(wanted)
        if topic.msg_type != msg_type:
            raise LabError(
                f'{topic.name} must be of type {msg_type}, but it is of type {topic.msg_type}.'
            )
        return topic.name
    space = near.rpartition('/')[0]
    found = [topic for topic in bag.topics if topic.msg_type == msg_type and topic.count]
    found.sort(key=lambda topic: (topic.name.rpartition('/')[0] != space, -topic.count))
    return found[0].name if found else ''


def read_track(bag: Bag, topic: str, progress: Progress) -> Track:
    """Return the path of a robot.

    Raises:
        LabError: The bag is damaged.
    """
    rows: list[tuple[float, ...]] = []
    for seconds, message in _sampled(bag, topic, progress):
        motion = motion_of(message)
        if motion is not None:
            rows.append((seconds, *motion[0], *motion[1]))
    table = np.array(rows, dtype=np.float64).reshape(-1, 6)
    return Track(topic, table[:, 0], table[:, 1:])


def check_field(bag: Bag, source: Source) -> None:
    """Raise a LabError unless a bag has this topic and field, and it is a number."""
    topic = bag.topic(source.topic)
    if topic.count:
        _getter(bag, topic, source)


def read_samples(bag: Bag, sources: Sequence[Source], progress: Progress) -> list[Samples]:
    """Return the numbers of fields of one topic; `progress` is called with 0 to 1.

    Raises:
        LabError: There is no such field, or it is not a number.
    """
    topic = bag.topic(sources[0].topic)
    if not topic.count:
        none = np.empty(0)
        words = f'{topic.name} has no messages in this bag.'
        return [Samples(source, '', none, none, 1, words) for source in sources]
    getters = [_getter(bag, topic, source) for source in sources]
    times: list[float] = []
    values: list[list[float]] = [[] for _ in sources]
    problem = ''
    try:
        for seconds, message in _sampled(bag, topic.name, progress):
            times.append(seconds)
            for (get, _), numbers in zip(getters, values, strict=True):
                numbers.append(_number(get, message))
    except LabError as error:
        problem = error.message
    moments = np.array(times, dtype=np.float64)
    return [
        Samples(source, unit, moments, np.array(numbers), _step(topic.count), problem)
        for source, (_, unit), numbers in zip(sources, getters, values, strict=True)
    ]


def number_paths(message: Any) -> list[str]:
    """Return the paths of a message's numbers; of an array, that of the first element."""
    found: list[str] = []
    for path in _paths(message, ''):
        found.append(path)
        if len(found) >= MAX_FIELDS:
            break
    # Stamps and covariances are seldom wanted.
    return sorted(found, key=lambda path: ('covariance' in path, path.startswith('header.')))


# --- Details -------------------------------------------------------------------------------------


def _step(count: int) -> int:
    return math.ceil(count / MAX_SAMPLES) or 1


def _sampled(bag: Bag, topic: str, progress: Progress) -> Iterator[tuple[float, Any]]:
    """Yield times and messages of a topic: all, or every n-th."""
    stamps = np.unique(bag.stamps(topic))
    chosen = stamps[:: _step(len(stamps))]
    for number, stamp in enumerate(chosen.tolist()):
        progress(number / len(chosen))
        found = bag.at(topic, stamp)
        if found is not None:
            yield (stamp - bag.start_ns) / 1e9, found.message


def _getter(bag: Bag, topic: BagTopic, source: Source) -> tuple[Callable[[Any], Any], str]:
    """Return a function that reads a field of a message, and its unit.

    Raises:
        LabError: There is no such field, or it is not a number.
    """
    try:
        msg_type = message_class(topic.msg_type)
    except Refused:
        return _foreign_getter(bag, topic, source), ''
    return resolve(source, msg_type), unit_of(source.path, msg_type)


def _foreign_getter(bag: Bag, topic: BagTopic, source: Source) -> Callable[[Any], Any]:
    """Return a function that reads a field of a message whose type is not installed."""

    def take(message: Any, part: tuple[str, str]) -> Any:
        name, index = part
        value = getattr(message, name)
        return value[int(index)] if index else value

    parts = re.findall(r'(\w+)(?:\[(\d+)\])?', source.path)

    def get(message: Any) -> Any:
        return reduce(take, parts, message)

    first = bag.at(topic.name, int(bag.stamps(topic.name)[0]))
    assert first is not None
    message = first.message
    try:
        value = get(message)
    except IndexError:
        return get
    except (AttributeError, TypeError):
        value = None
    if not _is_number(value):
        paths = number_paths(message)
        near = nearest(source.path, paths)
        todo = (
            f'Did you mean {f"{source.topic}.{near}"!r}?'
            if near
            else f'Its numbers: {", ".join(paths[:4]) or "none"}.'
        )
        raise LabError(
            f'{quoted(source.text)}: {topic.msg_type} has no number {quoted(source.path)}.',
            todo=todo,
        )
    return get


def _number(get: Callable[[Any], Any], message: Any) -> float:
    try:
        return float(get(message))
    except IndexError:
        # This message has a shorter array.
        return math.nan


def _paths(message: Any, start: str) -> Iterator[str]:
    for name in fields_of(message):
        value, path = getattr(message, name), f'{start}{name}'
        if not isinstance(value, (str, bytes)) and hasattr(value, '__len__') and len(value):
            value, path = value[0], f'{path}[0]'
        if is_message(value):
            yield from _paths(value, f'{path}.')
        elif _is_number(value):
            yield path


def _is_number(value: Any) -> bool:
    return isinstance(value, (bool, int, float, np.number, np.bool_))
