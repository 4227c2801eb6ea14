"""`ros2 topic hz`, `bw` and `delay`: rate, bandwidth and age of messages."""

from __future__ import annotations

import argparse
import functools
import math
import time
from argparse import Namespace
from collections import deque
from collections.abc import Callable, Iterable
from typing import Any, NoReturn

from labkit.asking.silence import why_silent
from labkit.errors import LabError
from labkit.ros2.graph_completion import topic_names
from labkit.ros2.graph_queries import add_discovery_options, asking_node, full_name
from labkit.ros2.parser import Parser, Verb, positive_int
from labkit.ros2.streams import (
    Arrivals,
    Filter,
    Stop,
    add_filter_option,
    add_stop_options,
    subscribed,
    wait_for_type,
)
from labkit.rosgraph import interfaces
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.qos_profiles import make_profile

__all__ = ['BW', 'DELAY', 'HZ']

REPORT_SEC = 1.0
HZ_WINDOW = 10000
BW_WINDOW = 100


class Window:
    """The latest values of a measurement.

    Args:
        size: Number of values to keep.
    """

    def __init__(self, size: int) -> None:
        self.values: deque[tuple[float, float]] = deque(maxlen=size)
        self.total = 0

    def add(self, value: float) -> None:
        """Add a value with the current time."""
        self.total += 1
        self.values.append((time.monotonic(), value))

    def numbers(self) -> list[float]:
        """Return the values, oldest first."""
        return [value for _, value in self.values.copy()]


def statistics(values: list[float]) -> tuple[float, float, float, float]:
    """Return mean, least, greatest and standard deviation."""
    mean = sum(values) / len(values)
    spread = math.sqrt(sum((value - mean) ** 2 for value in values) / len(values))
    return mean, min(values), max(values), spread


def hz(args: Namespace) -> str | None:
    """Print the rate of messages."""
    window = Window(args.window_size)
    last: list[float] = []

    def arrived(_: Any) -> None:
        now = time.monotonic()
        if last:
            window.add(now - last[0])
        last[:] = [now]

    def report() -> str:
        mean, least, greatest, spread = statistics(window.numbers())
        return (
            f'average rate: {1 / mean if mean > 0 else 0:.3f}\n\tmin: {least:.3f}s max: '
            f'{greatest:.3f}s std dev: {spread:.5f}s window: {len(window.values)}'
        )

    return _measure(args, args.topic_name, window, arrived, report, raw=args.filter_expr is None)


def bandwidth(args: Namespace) -> str | None:
    """Print the bandwidth of messages."""
    window = Window(args.window_size)

    def report() -> str:
        sizes = window.numbers()
        span = time.monotonic() - window.values[0][0]
        rate = sum(sizes) / span if span > 0 else 0.0
        unit, size = next(
            (unit, size)
            for limit, unit, size in ((1e3, 'B', 1), (1e6, 'KB', 1e3), (math.inf, 'MB', 1e6))
            if rate < limit
        )
        digits = 0 if unit == 'B' else 2
        bw, mean, least, greatest = (
            f'{value / size:.{digits}f} {unit}'
            for value in (rate, sum(sizes) / len(sizes), min(sizes), max(sizes))
        )
        return (
            f'{bw}/s from {len(sizes)} messages\n\tMessage size mean: {mean} min: {least} '
            f'max: {greatest}'
        )

    def arrived(message: bytes) -> None:
        window.add(len(message))

    return _measure(
        args, args.topic_name, window, arrived, report, raw=True, begin='Subscribed to [{}]'
    )


def delay(args: Namespace) -> str | None:
    """Print the age of messages on arrival, by the time stamp in their header."""
    from rclpy.time import Time

    node = asking_node(args)
    window = Window(args.window_size)

    def arrived(message: Any) -> None:
        age = node.get_clock().now() - Time.from_msg(message.header.stamp)
        window.add(age.nanoseconds * 1e-9)

    def report() -> str:
        mean, least, greatest, spread = statistics(window.numbers())
        return (
            f'average delay: {mean:.3f}\n\tmin: {least:.3f}s max: {greatest:.3f}s std dev: '
            f'{spread:.5f}s window: {len(window.values)}'
        )

    return _measure(args, args.topic_name, window, arrived, report, raw=False, needs_header=True)


def _measure(
    args: Namespace,
    topic: str,
    window: Window,
    arrived: Callable[[Any], None],
    report: Callable[[], str],
    *,
    raw: bool,
    begin: str = '',
    needs_header: bool = False,
) -> str | None:
    """Subscribe to a topic, and print a report in each second with new messages."""
    stop = Stop(args.count, args.timeout)
    node = asking_node(args)
    topic = full_name(topic, node)
    name = wait_for_type(node, topic, stop, typed=args.topic_name)
    if name is None:
        return f'No message came: {topic} has not appeared.'
    msg_type = interfaces.message_class(name)
    if needs_header and 'header' not in msg_type.get_fields_and_field_types():
        raise LabError(
            'msg does not have header',
            todo=f'{type_name(msg_type)} carries no time stamp, so its delay is not known.',
        )
    wanted = Filter(args, msg_type())
    if begin:
        print(begin.format(args.topic_name), flush=True)
    due = time.monotonic() + REPORT_SEC
    reported = 0

    def look() -> None:
        nonlocal due, reported
        if time.monotonic() < due:
            return
        due += REPORT_SEC
        if window.total > reported:
            reported = window.total
            print(report(), flush=True)
            stop.count_one()

    arrivals = Arrivals()

    def fail(error: LabError) -> NoReturn:
        raise error

    def take(message: Any) -> None:
        try:
            if wanted.passes(message):
                arrived(message)
        except LabError as error:
            arrivals.put(functools.partial(fail, error))

    profile = make_profile('sensor_data')
    with subscribed(node, topic, msg_type, profile, take, raw=raw):
        arrivals.show_until(stop, look)
        if window.total:
            return None
        return (
            wanted.why_none() or f'No message came. {why_silent(node, topic, msg_type, profile)}'
        )


def _arguments(
    parser: Parser, help_of_topic: str, window: int, more: Iterable[tuple[str, str]] = ()
) -> None:
    add_discovery_options(parser)
    parser.add('topic_name', help=help_of_topic, complete=topic_names)
    parser.add(
        *('-w', '--window'),
        dest='window_size',
        type=positive_int,
        default=window,
        metavar='WINDOW',
        help=f'window size, in # of messages, for calculating rate (default: {window})',
    )
    for name, text in more:
        parser.flag(name, text)
    add_stop_options(parser, 'reports')
    parser.flag('--include-hidden-topics', argparse.SUPPRESS)


def _hz_arguments(parser: Parser) -> None:
    text = 'calculates rate using wall time, which is what is done here anyway'
    _arguments(
        parser,
        "Name of the ROS topic to listen to (e.g. '/chatter')",
        HZ_WINDOW,
        [('--wall-time', text)],
    )
    add_filter_option(parser)


def _bw_arguments(parser: Parser) -> None:
    _arguments(parser, 'Topic name to monitor for bandwidth utilization', BW_WINDOW)


def _delay_arguments(parser: Parser) -> None:
    _arguments(parser, 'Topic name to calculate the delay for', HZ_WINDOW)


HZ = Verb('hz', 'Print the average receiving rate to screen', hz, _hz_arguments)
BW = Verb('bw', 'Display bandwidth used by topic', bandwidth, _bw_arguments)
DELAY = Verb('delay', 'Display delay of topic from timestamp in header', delay, _delay_arguments)
