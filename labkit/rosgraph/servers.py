"""Services and actions by server node, and the nodes at both ends of an action."""

from __future__ import annotations

from dataclasses import dataclass

from rclpy.node import Node

from labkit.rosgraph.listings import NamesAndTypes, ends_of_node
from labkit.rosgraph.names import EVERY_NODE_OFFERS
from labkit.rosgraph.snapshot import node_names

__all__ = ['ActionEnds', 'Server', 'action_ends', 'servers']


@dataclass(frozen=True)
class Server:
    """A service or an action that a node offers.

    Attributes:
        node: Full name of the node.
        service: Full name of the service or action.
        srv_type: Name of its type, such as `std_srvs/srv/SetBool` or `test_msgs/action/Fibonacci`.
    """

    node: str
    service: str
    srv_type: str

    @property
    def is_action(self) -> bool:
        """Whether it is an action."""
        return '/action/' in self.srv_type


def servers(node: Node) -> list[Server]:
    """Return the services and actions of all nodes, sorted by name.

    Services that every node has are left out. A service appears in the graph after its node.
    """
    found = []
    for name in sorted({*node_names(node)}):
        ends = ends_of_node(node, name)
        every = {f'{name}/{service}' for service in EVERY_NODE_OFFERS}
        found += [
            Server(name, service, types[0])
            for service, types in sorted([*ends.service_servers, *ends.action_servers])
            if service not in every
        ]
    return found


@dataclass(frozen=True)
class ActionEnds:
    """The nodes at both ends of an action: full names, each with the types it uses."""

    servers: NamesAndTypes
    clients: NamesAndTypes


def action_ends(node: Node, action: str) -> ActionEnds:
    """Return the nodes that have a server or a client of an action."""
    servers, clients = [], []
    for name in sorted({*node_names(node)}):
        ends = ends_of_node(node, name, include_hidden=True)
        servers += [(name, types) for other, types in ends.action_servers if other == action]
        clients += [(name, types) for other, types in ends.action_clients if other == action]
    return ActionEnds(servers, clients)
