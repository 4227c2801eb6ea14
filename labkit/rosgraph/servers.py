"""Services and actions by the nodes that offer them, as the graph knows them."""

from __future__ import annotations

from dataclasses import dataclass

from rclpy.node import Node

from labkit.rosgraph.listings import ends_of_node
from labkit.rosgraph.snapshot import node_names

__all__ = ['Server', 'servers']

# What rclpy gives every node, under its name (rclpy/parameter_service.py and
# rclpy/type_description_service.py).
_OF_EVERY_NODE = (
    'describe_parameters',
    'get_parameter_types',
    'get_parameters',
    'get_type_description',
    'list_parameters',
    'set_parameters',
    'set_parameters_atomically',
)


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
        """Tell whether it is an action."""
        return '/action/' in self.srv_type


def servers(node: Node) -> list[Server]:
    """Return the services and actions that nodes offer, in order of names.

    Without the services that every node has. A service comes into the graph after the name of
    its node.

    Args:
        node: The node to ask with.
    """
    found = []
    for name in sorted({*node_names(node)}):
        ends = ends_of_node(node, name)
        every = {f'{name}/{service}' for service in _OF_EVERY_NODE}
        found += [
            Server(name, service, types[0])
            for service, types in sorted([*ends.service_servers, *ends.action_servers])
            if service not in every
        ]
    return found
