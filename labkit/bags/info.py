"""A summary of a bag, in the words of the real `ros2 bag info`."""

from __future__ import annotations

import time

from labkit.bags.reader import Bag, BagTopic
from labkit.errors import printable

__all__ = ['describe', 'size_in_words', 'topic_names']

_INDENT = 19
_SERVICE_END, _SERVICE_TYPE_END = '/_service_event', '_Event'


def describe(bag: Bag) -> str:
    """Return the output of the real command."""
    topics = [topic for topic in bag.topics if not _is_service(topic)]
    services = [topic for topic in bag.topics if _is_service(topic)]
    messages = sum(topic.count for topic in topics)
    indent = '\n' + ' ' * _INDENT
    lines = [
        '',
        f'Files:             {indent.join(map(printable, bag.files))}',
        f'Bag size:          {size_in_words(bag.size_bytes)}',
        f'Storage id:        {bag.storage}',
        f'ROS Distro:        {bag.ros_distro}',
        f'Duration:          {_seconds(bag.end_ns - bag.start_ns)}s',
        f'Start:             {_moment(bag.start_ns)}',
        f'End:               {_moment(bag.end_ns)}',
        f'Messages:          {messages}',
        f'Topic information: {indent.join(map(_topic, topics))}',
        f'Service:           {len(services)}',
        f'Service information: {(indent + "  ").join(map(_service, services))}',
    ]
    return '\n'.join(lines) + '\n' * bool(services)


def topic_names(bag: Bag) -> list[str]:
    """Return the names of the topics, without those of service events."""
    return [printable(topic.name) for topic in bag.topics if not _is_service(topic)]


def size_in_words(size: int) -> str:
    """Return a size with its unit, such as `'1.5 MiB'`."""
    value, units = float(size), ['B', 'KiB', 'MiB', 'GiB', 'TiB']
    while value >= 1024 and len(units) > 1:
        value /= 1024
        del units[0]
    return f'{value:.0f} B' if units[0] == 'B' else f'{value:.1f} {units[0]}'


def _topic(topic: BagTopic) -> str:
    return printable(
        f'Topic: {topic.name} | Type: {topic.msg_type} | Count: {topic.count} | '
        f'Serialization Format: {topic.serialization_format}'
    )


def _service(topic: BagTopic) -> str:
    name = topic.name.removesuffix(_SERVICE_END)
    msg_type = topic.msg_type.removesuffix(_SERVICE_TYPE_END)
    return printable(
        f'Service: {name} | Type: {msg_type} | Event Count: {topic.count} | '
        f'Serialization Format: {topic.serialization_format}'
    )


def _is_service(topic: BagTopic) -> bool:
    named = topic.name.endswith(_SERVICE_END)
    return named and '/srv/' in topic.msg_type and topic.msg_type.endswith(_SERVICE_TYPE_END)


def _seconds(duration_ns: int) -> str:
    sec, nsec = divmod(duration_ns, 10**9)
    return f'{sec}.{nsec:09}'


def _moment(stamp_ns: int) -> str:
    local = time.localtime(stamp_ns // 10**9)
    date = f'{time.strftime("%b", local)} {local.tm_mday:2} {local.tm_year}'
    at = f'{time.strftime("%H:%M:%S", local)}.{stamp_ns % 10**9:09}'
    return f'{date} {at} ({_seconds(stamp_ns)})'
