"""What verbs share that ask the graph: their options, the node to ask with, unknown names."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from labkit.background import discovery
from labkit.background.discovery import DISCOVERY_SEC, soon
from labkit.errors import LabError, nearest
from labkit.ros2.parser import Parser, positive_float
from labkit.rosgraph.snapshot import node_names

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['add_discovery_options', 'asking_node', 'check_node_name', 'unknown']


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
