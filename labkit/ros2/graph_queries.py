"""Helpers of verbs that query the graph: common options, the querying node, unknown names."""

from __future__ import annotations

import sys
from argparse import Namespace
from typing import TYPE_CHECKING, Any

from labkit import settings
from labkit.asking import discovery
from labkit.asking.discovery import DISCOVERY_SEC, SOON_SEC, poll_until
from labkit.asking.notebook_graph import KINDS, ask_notebook
from labkit.background.runtime import runtime
from labkit.errors import LabError, nearest
from labkit.ros2.parser import Parser, Usage, positive_float, real_one
from labkit.rosgraph.interfaces import check_exists, type_name
from labkit.rosgraph.listings import NamesAndTypes
from labkit.rosgraph.matching import other_type_here
from labkit.rosgraph.names import full_topic_name, is_hidden
from labkit.rosgraph.refusals import Refusal, Refused
from labkit.rosgraph.snapshot import node_names

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = [
    'add_discovery_options',
    'asking_node',
    'check_node_name',
    'full_name',
    'known_names',
    'other_type',
    'print_names',
    'print_names_of',
    'unknown',
    'values_text',
]


def add_discovery_options(parser: Parser) -> None:
    """Add the options of all commands that query the graph."""
    parser.add(
        '--spin-time',
        type=positive_float,
        default=DISCOVERY_SEC,
        metavar='SPIN_TIME',
        help='seconds to wait for discovery, if ROS was started just now',
    )
    parser.flag('-s, --use-sim-time', 'accepted, without effect')
    parser.flag('--no-daemon', 'look for nodes anew, and do not ask a running notebook')


def asking_node(args: Namespace) -> Node:
    """Return the node to query the graph with; start ROS if it is not up.

    Args:
        args: The arguments of the verb, maybe with `spin_time`.
    """
    return discovery.asking_node(getattr(args, 'spin_time', DISCOVERY_SEC))


def known_names(args: Namespace, kind: str, *, include_hidden: bool = False) -> NamesAndTypes:
    """Return names with their types, as a running notebook knows them, or else this process.

    Args:
        args: The arguments of the verb.
        kind: One of `KINDS`; nodes have no types.
        include_hidden: Whether to include hidden ones.
    """
    own = runtime.started or getattr(args, 'no_daemon', False)
    told = None if own else ask_notebook(kind)
    found = KINDS[kind](asking_node(args)) if told is None else told
    return [each for each in found if include_hidden or not is_hidden(each[0])]


def print_names(args: Namespace, found: NamesAndTypes, count: bool) -> None:
    """Print names, with their types if the verb was asked to, or how many they are."""
    if count:
        print(len(found))
        return
    for name, types in found:
        print(f'{name} [{", ".join(types)}]' if args.show_types else name)


def print_names_of(msg_type: str, kind: str, found: NamesAndTypes, count: bool) -> None:
    """Print the names that have a type, or how many they are.

    Args:
        msg_type: Name of the type.
        kind: Its kind, `'msg'` or `'srv'`.
        found: The names to choose from.
        count: Whether to print the number alone.
    """
    names = [name for name, types in found if msg_type in types]
    if not names:
        with real_one(says='', shows='0' if count else '', code=0):
            check_exists(msg_type, kind)
    print(len(names)) if count else print('\n'.join(names), end='\n' * bool(names))


def check_node_name(node: Node, name: str, *, timeout_sec: float = SOON_SEC) -> str:
    """Return the full name of a node of the graph.

    Args:
        node: The node to ask with.
        name: The name as typed; the leading slash is optional.
        timeout_sec: Seconds to wait for it.

    Raises:
        LabError: There is no such node.
    """
    full_name = name if name.startswith('/') else f'/{name}'
    if not poll_until(lambda: full_name in node_names(node), timeout_sec):
        with real_one():
            raise LabError('Node not found', todo=unknown(full_name, node_names(node), 'node'))
    return full_name


def full_name(name: str, node: Node) -> str:
    """Return the full name of a topic or service, which need not exist.

    Args:
        name: The name as typed; the leading slash is optional.
        node: The node to ask with.

    Raises:
        Refused: The name is invalid.
    """
    try:
        return full_topic_name(name, node)
    except LabError as error:
        reason = Refusal.REPEATED_SLASH if '//' in name else Refusal.BAD_NAME
        raise Refused(error.message, todo=error.todo, reason=reason) from error


def other_type(node: Node, topic: str, msg_type: Any, error: Exception) -> Refused:
    """Return the error for a topic that can't be used with a type.

    Args:
        node: The node to ask with.
        topic: Full name of the topic.
        msg_type: The requested type.
        error: The error of ROS, shown if nobody here uses another type.
    """
    why = other_type_here(node, topic, msg_type)
    return Refused(
        f'{topic} can not be used with messages of {type_name(msg_type)}. {why or error}',
        reason=Refusal.OTHER_TYPE if why else Refusal.OTHER,
    )


def unknown(name: str, names: list[str], what: str) -> str:
    """Return a hint for a name that does not exist: the nearest one, or how to list all.

    Args:
        name: The unknown name.
        names: The existing names.
        what: The kind of names, such as `'topic'`.
    """
    shown = [other for other in names if '/_' not in other]
    near = nearest(name, shown)
    if near:
        return f'Did you mean {near!r}?'
    if not shown:
        return f'There is no {what} at all.'
    return f'ros2 {what} list shows the {what}s that exist.'


def values_text(args: Namespace, verb: str, values: str) -> str:
    """Return the YAML of a message: an argument or, with `--stdin`, standard input."""
    if not args.stdin:
        return values
    if settings.in_kernel():
        raise Usage(f'ros2 {verb}: --stdin works in a terminal only.')
    return sys.stdin.read()
