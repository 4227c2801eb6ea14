"""`ros2 node`: list nodes, and show a node's endpoints."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Iterable
from typing import TYPE_CHECKING

from labkit.asking.discovery import poll_until
from labkit.errors import LabError
from labkit.ros2.graph_completion import node_names
from labkit.ros2.graph_queries import add_discovery_options, asking_node, known_names, unknown
from labkit.ros2.parser import Command, Parser, Verb, real_one
from labkit.rosgraph.listings import ends_of_node
from labkit.rosgraph.names import is_hidden
from labkit.rosgraph.snapshot import node_names as names_of_nodes

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['COMMAND']


def list_nodes(args: Namespace) -> None:
    """Print the names of the nodes."""
    known = known_names(args, 'nodes', include_hidden=True)
    names = _shown((name for name, _types in known), args.all)
    if args.count_nodes:
        print(len(names))
        return
    if len(set(names)) < len(names):
        print(
            'WARNING: Be aware that there are nodes in the graph that share an exact name, which '
            'can have unintended side effects.',
            file=sys.stderr,
        )
    for name in names:
        print(name)


def show_info(args: Namespace) -> None:
    """Print the endpoints of a node."""
    node = asking_node(args)
    name = args.node_name
    count = poll_until(lambda: _nodes(node, args.include_hidden).count(name))
    if not count:
        hidden = name in _nodes(node, include_hidden=True)
        todo = unknown(name, _nodes(node, include_hidden=False), 'node')
        with real_one():
            raise LabError(
                f"Unable to find node '{name}'",
                todo='It is hidden. Add --include-hidden to see it.' if hidden else todo,
            )
    if count > 1:
        print(
            f'There are {count} nodes in the graph with the exact name "{name}". You are seeing '
            'information about only one of them.',
            file=sys.stderr,
        )
    ends = ends_of_node(node, name, include_hidden=args.include_hidden)
    print(name)
    for title, found in (
        ('Subscribers', ends.subscribers),
        ('Publishers', ends.publishers),
        ('Service Servers', ends.service_servers),
        ('Service Clients', ends.service_clients),
        ('Action Servers', ends.action_servers),
        ('Action Clients', ends.action_clients),
    ):
        print(f'  {title}:')
        print('\n'.join(f'    {entity}: {", ".join(types)}' for entity, types in found))


def _nodes(node: Node, include_hidden: bool) -> list[str]:
    return _shown(names_of_nodes(node), include_hidden)


def _shown(names: Iterable[str], include_hidden: bool) -> list[str]:
    # Only the name counts, not the namespace.
    return [name for name in names if include_hidden or not is_hidden(name.rpartition('/')[2])]


def _list_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.flag('-a, --all', 'Display all nodes even hidden ones')
    parser.flag('-c, --count-nodes', 'Only display the number of nodes discovered')


def _info_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.add(
        'node_name',
        help='Fully qualified node name to request information',
        complete=node_names,
    )
    parser.flag('--include-hidden', 'Display hidden topics, services, and actions as well')


COMMAND = Command(
    'node',
    'Various node related sub-commands',
    (
        Verb('info', 'Output information about a node', show_info, _info_arguments),
        Verb('list', 'Output a list of available nodes', list_nodes, _list_arguments),
    ),
)
