"""`ros2 topic`: list topics and their endpoints; and the verbs that stream."""

from __future__ import annotations

import argparse
from argparse import Namespace
from typing import TYPE_CHECKING

from labkit.asking.discovery import poll_until
from labkit.errors import LabError
from labkit.ros2.graph_completion import topic_names
from labkit.ros2.graph_queries import (
    add_discovery_options,
    asking_node,
    known_names,
    print_names,
    print_names_of,
    unknown,
)
from labkit.ros2.parser import Command, Parser, Verb, real_one
from labkit.ros2.topic_echo import ECHO
from labkit.ros2.topic_pub import PUB
from labkit.ros2.topic_rates import BW, DELAY, HZ
from labkit.rosgraph import interfaces
from labkit.rosgraph.listings import NamesAndTypes, topic_types, topics
from labkit.rosgraph.names import full_node_name

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.topic_endpoint_info import TopicEndpointInfo

__all__ = ['COMMAND']

HIDDEN = '--include-hidden-topics'


def list_topics(args: Namespace) -> None:
    """Print the names of the topics."""
    if args.verbose and not args.count_topics:
        node = asking_node(args)
        if found := topics(node, include_hidden=args.include_hidden_topics):
            print(_ends(node, found, publishers=True))
            print(_ends(node, found, publishers=False))
        return
    found = known_names(args, 'topics', include_hidden=args.include_hidden_topics)
    print_names(args, found, args.count_topics)


def show_info(args: Namespace) -> None:
    """Print a topic's type and its publishers and subscriptions."""
    node = asking_node(args)
    name = args.topic_name
    types = poll_until(lambda: topic_types(node, name))
    if not types:
        names = [topic for topic, _ in topics(node)]
        with real_one():
            raise LabError(f"Unknown topic '{name}'", todo=unknown(name, names, 'topic'))
    end = '\n\n' if args.verbose else '\n'
    print(f'Type: {types[0] if len(types) == 1 else types}', end=end)
    print(f'Publisher count: {node.count_publishers(name)}', end=end)
    if args.verbose:
        _print_each(node.get_publishers_info_by_topic(name))
    print(f'Subscription count: {node.count_subscribers(name)}', end=end)
    if args.verbose:
        _print_each(node.get_subscriptions_info_by_topic(name))


def show_type(args: Namespace) -> str | int:
    """Print a topic's type."""
    node = asking_node(args)
    types = poll_until(
        lambda: dict(topics(node, include_hidden=args.include_hidden_topics)).get(args.topic_name)
    )
    if not types:
        names = [topic for topic, _ in topics(node)]
        with real_one(says=''):
            raise LabError(
                f"Unknown topic '{args.topic_name}'", todo=unknown(args.topic_name, names, 'topic')
            )
    print('\n'.join(types))
    return 0


def find(args: Namespace) -> None:
    """Print the topics of a type."""
    found = known_names(args, 'topics', include_hidden=args.include_hidden_topics)
    print_names_of(args.topic_type, 'msg', found, args.count_topics)


def _ends(node: Node, found: NamesAndTypes, *, publishers: bool) -> str:
    """Return the list of topics that have publishers, or of those that have subscribers."""
    count_of = node.count_publishers if publishers else node.count_subscribers
    word = 'publisher' if publishers else 'subscriber'
    lines = ['Published topics:' if publishers else 'Subscribed topics:']
    for name, types in found:
        count = count_of(name)
        if count:
            plural = 's' if count > 1 else ''
            lines += [f' * {name} [{", ".join(types)}] {count} {word}{plural}']
    return '\n'.join(lines) + '\n'


def _print_each(infos: list[TopicEndpointInfo]) -> None:
    ordered = sorted(infos, key=lambda end: full_node_name(end.node_name, end.node_namespace))
    for info in ordered:
        print(info, end='\n\n')


def _hidden_options(parser: Parser, *, shown: bool) -> None:
    text = 'Consider hidden topics as well' if shown else argparse.SUPPRESS
    parser.flag(HIDDEN, text)


def _list_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.flag('-t, --show-types', 'Additionally show the topic type')
    parser.flag('-c, --count-topics', 'Only display the number of topics discovered')
    parser.flag('-v, --verbose', 'List full details about each topic')
    _hidden_options(parser, shown=True)


def _name_argument(parser: Parser, text: str) -> None:
    parser.add('topic_name', help=text, complete=topic_names)


def _info_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    _name_argument(parser, "Name of the ROS topic to get info (e.g. '/chatter')")
    parser.flag(
        '-v, --verbose',
        'Prints detailed information like the node name, node namespace, topic type, topic '
        'type hash, GUID, and QoS Profile of the publishers and subscribers to this topic',
    )
    _hidden_options(parser, shown=False)


def _type_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    _name_argument(parser, "Name of the ROS topic to get type (e.g. '/chatter')")
    _hidden_options(parser, shown=False)


def _find_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.add(
        'topic_type',
        help="Name of the ROS topic type to filter for (e.g. 'std_msgs/msg/String')",
        complete=lambda _: interfaces.names('msg'),
    )
    parser.flag('-c, --count-topics', 'Only display the number of topics discovered')
    parser.flag(HIDDEN, 'Consider hidden topics as well')


COMMAND = Command(
    'topic',
    'Various topic related sub-commands',
    (
        BW,
        DELAY,
        ECHO,
        Verb(
            'find',
            'Output a list of available topics of a given type',
            find,
            _find_arguments,
            'A type that is not installed is an error here, with exit code 1; the real one finds '
            'nothing, as this one does into a pipe.',
        ),
        HZ,
        Verb('info', 'Print information about a topic', show_info, _info_arguments),
        Verb('list', 'Output a list of available topics', list_topics, _list_arguments),
        PUB,
        Verb(
            'type',
            "Print a topic's type",
            show_type,
            _type_arguments,
            'An unknown topic is told here; the real one only ends with exit code 1, as this one '
            'does into a pipe.',
        ),
    ),
    {HIDDEN: 'Consider hidden topics as well'},
)
