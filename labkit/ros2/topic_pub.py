"""`ros2 topic pub`: publish a message on a topic."""

from __future__ import annotations

import argparse
import itertools
import math
import sys
import time
from argparse import Namespace
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from labkit import settings
from labkit.background.compat import RCLError
from labkit.background.delivery import MATCH_SEC, wait_for_known, wait_until_taken
from labkit.background.nodes import destroy_node
from labkit.background.runtime import runtime
from labkit.errors import LabError, nearest
from labkit.ros2.asking import add_discovery_options, asking_node, full_name, other_type
from labkit.ros2.graph_words import topic_names, types_of_topic
from labkit.ros2.parser import Parser, Usage, Verb, positive_float, unsigned_int
from labkit.ros2.qos_options import add_qos_options, profile_from
from labkit.ros2.streams import MAX_SHOWN, Stop, tell
from labkit.rosgraph import interfaces
from labkit.rosgraph.listings import topics
from labkit.rosgraph.message_yaml import fill, no_dictionary, prototype, read_yaml

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.publisher import Publisher

__all__ = ['PUB']

POLL_SEC = 0.01


def pub(args: Namespace) -> str | None:
    """Publish until a count, a time, or the stop button."""
    times = 1 if args.once else args.times
    if args.once and args.times:
        raise Usage('ros2 topic pub: --once and --times can not go together.')
    if args.wait_matching_subscriptions is None and args.max_wait_time_secs is not None:
        return '--max-wait-time-secs option is only effective with --wait-matching-subscriptions'
    stop = Stop(times or None, args.timeout)
    msg_type = interfaces.message_class(args.message_type)
    message = msg_type()
    setters = fill(message, _fields_in(_values(args)))
    asking = asking_node(args)
    topic = full_name(args.topic_name, asking)
    node = _node(args.node_name, asking)
    try:
        publisher = _publisher(node, topic, msg_type, args)
        try:
            wanted = args.wait_matching_subscriptions
            _wait_for_subscribers(
                asking,
                publisher,
                int(times != 0) if wanted is None else wanted,
                args.max_wait_time_secs,
                stop,
            )
            _publish(node, publisher, message, setters, args, stop)
        finally:
            node.destroy_publisher(publisher)
    finally:
        if node is not asking:
            destroy_node(node)
    return None


def _publish(
    node: Node,
    publisher: Publisher,
    message: Any,
    setters: list[Any],
    args: Namespace,
    stop: Stop,
) -> None:
    """Publish at the rate that was asked for."""
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
        while not stop.reached and time.monotonic() < start + count * period:
            time.sleep(max(0.0, min(stop.left_sec, start + count * period - time.monotonic())))
        if stop.reached:
            break
    time.sleep(args.keep_alive)  # so that the last message is on its way before the end
    wait_until_taken(publisher)


def _wait_for_subscribers(
    node: Node, publisher: Publisher, count: int, max_wait_sec: float | None, stop: Stop
) -> None:
    """Wait until enough subscribers are there, and say so each second."""
    started = time.monotonic()
    if max_wait_sec is None:
        max_wait_sec = settings.audience().patience_sec
    known = node.count_subscribers(publisher.topic_name) >= count
    hint = _other_topic(node, publisher.topic_name)
    due = started + (MATCH_SEC if known else 0.0)
    while publisher.get_subscription_count() < count and not stop.reached:
        now = time.monotonic()
        if max_wait_sec is not None and now >= started + max_wait_sec:
            raise LabError(
                f'Timed out waiting for subscribers: Expected {count} subscribers but only got '
                f'{publisher.get_subscription_count()} subscribers'
            )
        if now >= due:
            due = now + 1.0
            print(f'Waiting for at least {count} matching subscription(s)...', flush=True)
            if hint:
                print(hint, flush=True)
                hint = ''
        time.sleep(POLL_SEC)
    if count:
        wait_for_known(node, publisher)


def _other_topic(node: Node, topic: str) -> str:
    """Return a word on the topic that was probably meant, '' if this one has subscribers."""
    heard = [name for name, _ in topics(node) if node.count_subscribers(name)]
    near = '' if topic in heard else nearest(topic, heard)
    return f'Nobody subscribes to {topic}. Did you mean {near!r}?' if near else ''


def _node(name: str | None, asking: Node) -> Node:
    """Return the node to publish with: one of its own if it is to have a name."""
    from rclpy.node import Node

    if not name:
        return asking
    if any(entry.name == f'/{name}' for entry in runtime.nodes()):
        raise LabError(f'A node called /{name} runs in this notebook; choose another name.')
    try:
        return Node(name, start_parameter_services=False)
    except Exception as error:
        raise LabError(
            f'{name!r} is no name of a node: {str(error).splitlines()[0]}',
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
            f'The passed value needs to be a dictionary in YAML format, but it is {text!r}.',
        )
    return values


def _values(args: Namespace) -> str:
    if not args.stdin:
        return str(args.values)
    if settings.in_kernel():
        raise Usage('ros2 topic pub: --stdin works in a terminal only.')
    return sys.stdin.read()


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
    parser.add('--stdin', action='store_true', help='Read values from standard input')
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
    parser.add('-1', '--once', action='store_true', help='Publish one message and exit')
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
        help='The maximum wait time in seconds if --wait-matching-subscriptions is set',
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
    parser.add('--include-hidden-topics', action='store_true', help=argparse.SUPPRESS)


PUB = Verb('pub', 'Publish a message to a topic', pub, _arguments)
