"""`ros2 topic pub`: publish a message on a topic."""

from __future__ import annotations

import argparse
import itertools
import math
import time
from argparse import Namespace
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from labkit import settings
from labkit.asking.delivery import MATCH_SEC, wait_until_found, wait_until_taken
from labkit.background.compat import RCLError
from labkit.background.nodes import destroy_node
from labkit.background.runtime import runtime
from labkit.background.wait import wait_for
from labkit.errors import LabError, nearest, quoted
from labkit.ros2.graph_completion import topic_names, types_of_topic
from labkit.ros2.graph_queries import (
    add_discovery_options,
    asking_node,
    full_name,
    other_type,
    values_text,
)
from labkit.ros2.parser import Parser, Usage, Verb, positive_float, real_one, unsigned_int
from labkit.ros2.qos_options import add_qos_options, profile_from
from labkit.ros2.streams import MAX_SHOWN, Stop, tell
from labkit.rosgraph import interfaces
from labkit.rosgraph.listings import topics
from labkit.rosgraph.message_yaml import fill, no_dictionary, prototype, read_yaml

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.publisher import Publisher

__all__ = ['PUB']

# Time for a matched subscriber to receive the messages, s.
TAKEN_SEC = 5.0


def pub(args: Namespace) -> str | None:
    """Publish until a count, a timeout, or the stop button."""
    times = 1 if args.once else args.times
    if args.once and args.times:
        raise Usage('ros2 topic pub: --once and --times can not go together.')
    wanted = args.wait_matching_subscriptions
    wanted = int(times != 0) if wanted is None else wanted
    if not wanted and args.max_wait_time_secs is not None:
        return (
            '--max-wait-time-secs option is only effective with --wait-matching-subscriptions, '
            '--once or --times'
        )
    stop = Stop(times or None, args.timeout)
    msg_type = interfaces.message_class(args.message_type)
    message = msg_type()
    setters = fill(message, _fields_in(values_text(args, 'topic pub', args.values)))
    asking = asking_node(args)
    topic = full_name(args.topic_name, asking)
    node = _node(args.node_name, asking)
    try:
        publisher = _publisher(node, topic, msg_type, args)
        try:
            _wait_for_subscribers(asking, publisher, wanted, args.max_wait_time_secs, stop)
            _publish(node, asking, publisher, message, setters, args, stop)
        finally:
            node.destroy_publisher(publisher)
    finally:
        if node is not asking:
            destroy_node(node)
    return None


def _publish(
    node: Node,
    asking: Node,
    publisher: Publisher,
    message: Any,
    setters: list[Any],
    args: Namespace,
    stop: Stop,
) -> None:
    """Publish at the requested rate."""
    tell('publisher: beginning loop')
    period = 1 / args.rate
    start = time.monotonic()
    shown = 0
    most = MAX_SHOWN if settings.in_kernel() else math.inf
    for count in itertools.count(1):
        for set_time in setters:
            set_time(node.get_clock().now().to_msg())
        if args.print and count % args.print == 0 and shown < most:
            shown += 1
            tell(f'publishing #{count}: {message!r}\n')
            if shown == most:
                tell(f'{most} messages are shown. It goes on without showing them.')
        publisher.publish(message)
        stop.count_one()
        wait_for(lambda: stop.reached, start + count * period - time.monotonic())
        if stop.reached:
            break
    time.sleep(args.keep_alive)  # so that the last message is on its way before the end
    wait_until_taken(asking, [publisher], TAKEN_SEC)


def _wait_for_subscribers(
    node: Node, publisher: Publisher, count: int, max_wait_sec: float | None, stop: Stop
) -> None:
    """Wait for enough subscribers, with a line each second."""
    if max_wait_sec is None:
        max_wait_sec = settings.audience().patience_sec
    due = time.monotonic()
    end = math.inf if max_wait_sec is None else due + max_wait_sec
    known = node.count_subscribers(publisher.topic_name) >= count
    hint = _other_topic(node, publisher.topic_name) if settings.audience().wants_reasons else ''

    def enough() -> bool:
        return publisher.get_subscription_count() >= count or stop.reached

    due += MATCH_SEC * known
    while not wait_for(enough, min(due, end) - time.monotonic()):
        if time.monotonic() >= due:
            print(f'Waiting for at least {count} matching subscription(s)...', flush=True)
            if hint:
                print(hint, flush=True)
                hint = ''
            due += 1.0
        if time.monotonic() >= end:
            got = publisher.get_subscription_count()
            text = 'Timed out waiting for subscribers: Expected {} {} but only got {} subscribers'
            # A script may look for the word as the real one spells it.
            with real_one(says=text.format(count, 'subcribers', got)):
                raise LabError(text.format(count, 'subscribers', got))
    if count:
        wait_until_found(node, [publisher])


def _other_topic(node: Node, topic: str) -> str:
    """Return a hint at the topic that was probably meant, '' if this one has subscribers."""
    heard = [name for name, _ in topics(node) if node.count_subscribers(name)]
    near = '' if topic in heard else nearest(topic, heard)
    return f'Nobody subscribes to {topic}. Did you mean {near!r}?' if near else ''


def _node(name: str | None, asking: Node) -> Node:
    """Return the node to publish with: a new one if a name is requested."""
    from rclpy.node import Node

    if not name:
        return asking
    if any(entry.name == f'/{name}' for entry in runtime.nodes()):
        raise LabError(f'A node called /{name} runs in this notebook; choose another name.')
    try:
        return Node(name, start_parameter_services=False)
    except Exception as error:
        raise LabError(
            f'{quoted(name)} is no name of a node: {str(error).splitlines()[0]}',
            todo='Use letters, digits and _, such as my_talker.',
        ) from error


def _publisher(node: Node, topic: str, msg_type: Any, args: Namespace) -> Publisher:
    try:
        return node.create_publisher(msg_type, topic, profile_from(args))
    except (RCLError, LabError) as error:
        raise other_type(node, topic, msg_type, error) from error


def _fields_in(text: str) -> dict[str, Any]:
    values = read_yaml(text)
    if not isinstance(values, dict):
        raise no_dictionary(
            values,
            f'The passed value needs to be a dictionary in YAML format, but it is {quoted(text)}.',
        )
    return values


def _prototype(args: Namespace) -> Iterable[str]:
    msg_type = interfaces.message_class(getattr(args, 'message_type', '') or '')
    return [f'"{prototype(msg_type)}"']


def _arguments(parser: Parser) -> None:
    parser.add(
        'topic_name',
        help="Name of the ROS topic to publish to (e.g. '/chatter')",
        complete=topic_names,
    )
    parser.add(
        'message_type',
        help="Type of the ROS message (e.g. 'std_msgs/String')",
        complete=types_of_topic,
    )
    parser.add(
        'values',
        nargs='?',
        default='{}',
        help="Values to fill the message with in YAML format (e.g. 'data: Hello World'), "
        'otherwise the message will be published with default values; a time may be `now`, a '
        'header `auto`',
        complete=_prototype,
    )
    parser.flag('--stdin', 'Read values from standard input')
    parser.add(
        *('-r', '--rate'),
        metavar='N',
        type=positive_float,
        default=1.0,
        help='Publishing rate in Hz (default: 1)',
    )
    parser.add(
        *('-p', '--print'),
        metavar='N',
        type=unsigned_int,
        default=1,
        help='Only print every N-th published message (default: 1)',
    )
    parser.flag('-1, --once', 'Publish one message and exit')
    parser.add(
        *('-t', '--times'),
        metavar='N',
        type=unsigned_int,
        default=0,
        help='Publish this number of times and then exit',
    )
    parser.add(
        *('-w', '--wait-matching-subscriptions'),
        metavar='N',
        type=unsigned_int,
        help='Wait until finding the specified number of matching subscriptions. Defaults to 1 '
        'when using "-1"/"--once"/"--times", otherwise defaults to 0.',
    )
    parser.add(
        '--max-wait-time-secs',
        metavar='N',
        type=positive_float,
        help='The maximum wait time in seconds if --wait-matching-subscriptions, --once or '
        '--times is set',
    )
    parser.add(
        '--keep-alive',
        metavar='N',
        type=positive_float,
        default=0.1,
        help='Keep publishing node alive for N seconds after the last msg (default: 0.1)',
    )
    parser.add('-n', '--node-name', help='Name of the created publishing node')
    parser.add(
        '--timeout', metavar='N', type=positive_float, help='Exit after N seconds (only here)'
    )
    add_qos_options(parser, 'default')
    add_discovery_options(parser)
    parser.flag('--include-hidden-topics', argparse.SUPPRESS)


PUB = Verb(
    'pub',
    'Publish a message to a topic',
    pub,
    _arguments,
    'Values that a field can not hold, such as 1.5 for a whole number, are refused here, with '
    'exit code 1; the real one converts some of them.',
)
