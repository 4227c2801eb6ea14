"""What verbs share that ask the graph: their options, the node to ask with, unknown names."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING, Any

from labkit.background import discovery
from labkit.background.discovery import DISCOVERY_SEC, soon
from labkit.errors import LabError, nearest
from labkit.ros2.parser import Parser, positive_float
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.matching import other_type_here
from labkit.rosgraph.names import full_topic_name
from labkit.rosgraph.refusals import Refusal, Refused
from labkit.rosgraph.snapshot import node_names

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = [
    'add_discovery_options',
    'asking_node',
    'check_node_name',
    'full_name',
    'other_type',
    'unknown',
]


def add_discovery_options(parser: Parser) -> None:
    """Add the options that all commands have that look at the graph."""
    parser.add(
        '--spin-time',
        type=positive_float,
        default=DISCOVERY_SEC,
        metavar='SPIN_TIME',
        help='seconds to wait for discovery, if ROS was started just now',
    )
    parser.add('-s', '--use-sim-time', action='store_true', help='accepted, without effect')
    parser.add('--no-daemon', action='store_true', help='accepted; there is no daemon here')


def asking_node(args: Namespace) -> Node:
    """Return the node to ask the graph with. ROS is started if it is not up.

    Args:
        args: The arguments of the verb, perhaps with `spin_time`.
    """
    return discovery.asking_node(getattr(args, 'spin_time', DISCOVERY_SEC))


def check_node_name(node: Node, name: str, *, timeout_sec: float | None = None) -> str:
    """Return the full name of a node of the graph.

    Args:
        node: The node to ask with.
        name: The name as typed; the first slash may be missing.
        timeout_sec: Seconds to wait for it.

    Raises:
        LabError: There is no such node.
    """
    full_name = name if name.startswith('/') else f'/{name}'
    if not soon(lambda: full_name in node_names(node), timeout_sec):
        raise LabError('Node not found', todo=unknown(full_name, node_names(node), 'node'))
    return full_name


def full_name(name: str, node: Node) -> str:
    """Return the full name of a topic or service, which need not exist.

    Args:
        name: The name as typed; the first slash may be missing.
        node: The node to ask with.

    Raises:
        Refused: It is no name of a topic.
    """
    try:
        return full_topic_name(name, node)
    except LabError as error:
        reason = Refusal.REPEATED_SLASH if '//' in name else Refusal.BAD_NAME
        raise Refused(error.message, todo=error.todo, reason=reason) from error


def other_type(node: Node, topic: str, msg_type: Any, error: Exception) -> Refused:
    """Return what to raise when a topic can't be used with a type.

    Args:
        node: The node to ask with.
        topic: Full name of the topic.
        msg_type: The type that was asked for.
        error: What ROS has said. It is shown if nobody here uses another type.
    """
    why = other_type_here(node, topic, msg_type)
    return Refused(
        f'{topic} can not be used with messages of {type_name(msg_type)}. {why or error}',
        reason=Refusal.OTHER_TYPE if why else Refusal.OTHER,
    )


def unknown(name: str, names: list[str], what: str) -> str:
    """Return what to say of a name that does not exist: the nearest one, or all.

    Args:
        name: The name that was asked for.
        names: The names that exist.
        what: What they are names of, such as `'topic'`.
    """
    shown = [other for other in names if '/_' not in other]
    near = nearest(name, shown)
    if near:
        return f'Did you mean {near!r}?'
    if not shown:
        return f'There is no {what} at all.'
    return f'ros2 {what} list shows the {what}s that exist.'
