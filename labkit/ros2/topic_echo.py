"""`ros2 topic echo`: show the messages of a topic."""

from __future__ import annotations

import argparse
import functools
from argparse import Namespace
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import yaml

from labkit import settings
from labkit.asking.silence import why_silent
from labkit.background.runtime import runtime
from labkit.errors import LabError, did_you_mean
from labkit.ros2.graph_completion import topic_names, types_of_topic
from labkit.ros2.graph_queries import add_discovery_options, asking_node, full_name
from labkit.ros2.parser import (
    Parser,
    Verb,
    positive_float,
    positive_int,
    real_one,
    unsigned_int,
)
from labkit.ros2.qos_options import add_qos_options, matching_profile
from labkit.ros2.streams import (
    MAX_SHOWN,
    Arrivals,
    Filter,
    Stop,
    add_filter_option,
    subscribed,
    tell,
    wait_for_type,
)
from labkit.rosgraph import interfaces
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.message_yaml import field_paths, to_csv, to_yaml

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['ECHO', 'add_form_options', 'text_of']

TRUNCATE_LENGTH = 128
SETTLE_SEC = 2.0


def echo(args: Namespace) -> None:
    """Show messages until a count, a timeout, or the stop button."""
    stop = Stop(1 if args.once else args.count, args.timeout)
    node = asking_node(args)
    topic = full_name(args.topic_name, node)
    msg_type = _type_of(node, topic, args, stop)
    if msg_type is None:
        # A person waits for it, and ends that; the real one does not even begin.
        with real_one(says='Could not determine the type for the passed topic'):
            raise LabError(f'No message came: {topic} has not appeared.')
    fields = _check_field(args.field, msg_type)
    wanted = Filter(args, b'' if args.raw else _part_of(msg_type(), fields))
    profile, notes = matching_profile(args, node, topic)
    for note in notes:
        print(note)
    most = None if args.once or args.count or not settings.in_kernel() else MAX_SHOWN
    arrivals = Arrivals()
    show = functools.partial(_show, args, fields)
    seen = []

    def arrived(message: Any, info: dict[str, Any]) -> None:
        def print_it() -> None:
            if stop.reached:
                return
            if wanted.passes(_part_of(message, fields)):
                seen.append(True)
                show(message, info)
                stop.count_one()
                if len(seen) == most:
                    stop.now()
                    print(f'{most} messages are shown. Run the cell again to see more.')

        arrivals.put(print_it)

    def say(text: str) -> None:
        arrivals.put(lambda: tell(text))

    with subscribed(
        node,
        topic,
        msg_type,
        profile,
        arrived,
        say=say,
        report_lost=not args.no_lost_messages,
        raw=args.raw,
    ):
        arrivals.show_until(stop)
        if seen:
            return
        # The background may have had no turn yet; what was to be known at once is told all the
        # same. A message is too late.
        runtime.executor.settle(SETTLE_SEC)
        arrivals.show_rest()
        # With the real one, that is no fault.
        with real_one(says='', code=0):
            silent = f'No message came. {why_silent(node, topic, msg_type, profile)}'
            raise LabError(wanted.why_none() or silent)


def _type_of(node: Node, topic: str, args: Namespace, stop: Stop) -> Any:
    """Return the class of the topic's messages, None if it was time to stop."""
    if args.message_type is not None:
        return interfaces.message_class(args.message_type)
    is_patient = settings.audience().wants_reasons
    name = wait_for_type(node, topic, stop, typed=args.topic_name, is_patient=is_patient)
    return None if name is None else interfaces.message_class(name)


def _check_field(text: str | None, msg_type: Any) -> list[str]:
    """Return the parts of a field's path; raise a LabError if there is no such field."""
    if text is None:
        return []
    parts = [part for part in text.split('.') if part]
    if not parts:
        raise LabError(f"Invalid field value '{text}'")
    paths = list(field_paths(msg_type))
    path = '.'.join(parts)
    if path not in paths:
        fields = ', '.join(msg_type.get_fields_and_field_types())
        hint = did_you_mean(path, paths, f'Its fields: {fields}.')
        with real_one(says=f"Invalid field '{path}': {_why_not(msg_type, parts)}"):
            raise LabError(f"Invalid field '{path}': {type_name(msg_type)} has none.", todo=hint)
    return parts


def _why_not(msg_type: Any, parts: list[str]) -> str:
    """Return what Python says of the path of a field that a message does not have."""
    try:
        return str(_part_of(msg_type(), parts))
    except AttributeError as error:
        return str(error)


def _part_of(message: Any, fields: list[str]) -> Any:
    return functools.reduce(getattr, fields, message)


def _show(args: Namespace, fields: list[str], message: Any, info: dict[str, Any]) -> None:
    """Print one message."""
    part = _part_of(message, fields)
    if not hasattr(part, 'get_fields_and_field_types'):
        if args.include_message_info:
            print('---Got new message, message info:---')
            print(info)
            print('---Message data:---')
        tell(str(part), end='\n---\n')
    else:
        text, end = text_of(part, args)
        if args.include_message_info:
            text = (
                f'{",".join(map(str, info.values()))},{text}'
                if args.csv
                else f'{yaml.safe_dump(info)}---\n{text}'
            )
        tell(text, end=end)


def text_of(message: Any, args: Namespace) -> tuple[str, str]:
    """Return a message in the form that the options ask for, and what ends it."""
    form = {
        'truncate_length': None if args.full_length else args.truncate_length,
        'no_arr': args.no_arr,
        'no_str': args.no_str,
    }
    if args.csv:
        return to_csv(message, **form), '\n'
    return to_yaml(message, **form, flow_style=args.flow_style), '---\n'


def _fields(args: Namespace) -> Iterable[str]:
    """Return completion candidates for a field."""
    types = [getattr(args, 'message_type', None)]
    if not types[0] and getattr(args, 'topic_name', None):
        types = list(types_of_topic(args))
    return field_paths(interfaces.message_class(types[0])) if len(types) == 1 and types[0] else ()


def add_form_options(parser: Parser) -> None:
    """Add the options that say how a message is printed."""
    parser.flag('--csv', 'Output all recursive fields separated by commas (e.g. for plotting)')
    parser.flag(
        '-f, --full-length',
        'Output all elements for arrays, bytes, and string with a length > '
        "'--truncate-length'; by default they are cut",
    )
    parser.add(
        *('-l', '--truncate-length'),
        type=unsigned_int,
        default=TRUNCATE_LENGTH,
        metavar='N',
        help=f'The length to truncate arrays, bytes, and string to (default: {TRUNCATE_LENGTH})',
    )
    parser.flag('--no-arr', "Don't print array fields of messages")
    parser.flag('--no-str', "Don't print string fields of messages")
    parser.flag('--flow-style', 'Print each list on one line (not available with csv format)')


def _arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.add(
        'topic_name',
        help="Name of the ROS topic to listen to (e.g. '/chatter')",
        complete=topic_names,
    )
    parser.add(
        'message_type',
        nargs='?',
        help="Type of the ROS message (e.g. 'std_msgs/msg/String')",
        complete=types_of_topic,
    )
    add_qos_options(parser, 'sensor_data')
    add_form_options(parser)
    parser.add(
        '--field',
        help="Echo a selected field of a message. Use '.' to select sub-fields, as in "
        "'--field pose.pose.position'",
        complete=_fields,
    )
    parser.flag('--no-lost-messages', "Don't report when a message is lost")
    parser.flag('--raw', 'Echo the raw binary representation')
    parser.flag('--once', 'Print the first message received and then exit.')
    parser.add(
        '--timeout', metavar='N', type=positive_float, help='Set a timeout in seconds for waiting'
    )
    parser.add('--count', metavar='N', type=positive_int, help='Exit after N messages (only here)')
    parser.flag('-i, --include-message-info', 'Shows the associated message info.')
    add_filter_option(parser)
    parser.flag('--include-hidden-topics', argparse.SUPPRESS)


ECHO = Verb(
    'echo',
    'Output messages from a topic',
    echo,
    _arguments,
    'It waits for a topic that does not exist yet; the real one needs its type then. If no '
    'message has come before --timeout, that is exit code 1 here and 0 with the real one. '
    'Into a pipe, both are as with the real one. --filter takes any Python code there; here '
    'it is an expression that can change nothing.',
)
