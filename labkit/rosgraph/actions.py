"""Actions by the nodes that serve them and those that send goals, as the graph knows them."""

from __future__ import annotations

from dataclasses import dataclass

from rclpy.node import Node

from labkit.rosgraph.listings import NamesAndTypes, ends_of_node
from labkit.rosgraph.snapshot import node_names

__all__ = ['ActionEnds', 'action_ends']


@dataclass(frozen=True)
class ActionEnds:
    """Who is at either end of an action: full names of nodes, each with the types it uses."""

    servers: NamesAndTypes
    clients: NamesAndTypes


def action_ends(node: Node, action: str) -> ActionEnds:
    """Return the nodes that serve an action, and those that have a client for it.

    Args:
        node: The node to ask with.
        action: Full name of the action.
    """
    servers, clients = [], []
    for name in sorted({*node_names(node)}):
        ends = ends_of_node(node, name, include_hidden=True)
        servers += [(name, types) for other, types in ends.action_servers if other == action]
        clients += [(name, types) for other, types in ends.action_clients if other == action]
    return ActionEnds(servers, clients)
