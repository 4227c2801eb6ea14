"""Topics and services by name and type, and what one node has of them, actions included."""

from __future__ import annotations

from dataclasses import dataclass

from rclpy.action.graph import (
    get_action_client_names_and_types_by_node,
    get_action_names_and_types,
    get_action_server_names_and_types_by_node,
)
from rclpy.node import Node, NodeNameNonExistentError

from labkit.rosgraph.names import EVERY_NODE_HAS, is_hidden, split_node_name

__all__ = [
    'NamesAndTypes',
    'NodeEnds',
    'action_types',
    'actions',
    'ends_of_node',
    'own_topics',
    'service_types',
    'services',
    'topic_types',
    'topics',
]

NamesAndTypes = list[tuple[str, list[str]]]
"""Full names, each with the types that are in use there."""


@dataclass(frozen=True)
class NodeEnds:
    """What a node publishes, subscribes to, offers and calls, sorted by name."""

    subscribers: NamesAndTypes
    publishers: NamesAndTypes
    service_servers: NamesAndTypes
    service_clients: NamesAndTypes
    action_servers: NamesAndTypes
    action_clients: NamesAndTypes

    def names(self) -> dict[str, list[str]]:
        """Return the names alone, by what they are names of."""
        return {kind: [name for name, _types in found] for kind, found in vars(self).items()}


def topics(node: Node, *, include_hidden: bool = False) -> NamesAndTypes:
    """Return the topics, sorted by name.

    Args:
        node: The node to ask with.
        include_hidden: Whether to include hidden topics.
    """
    return _sorted(node.get_topic_names_and_types(), include_hidden)


def own_topics(node: Node) -> list[str]:
    """Return the names of the topics that somebody has made on purpose."""
    return [name for name, _ in topics(node) if name not in EVERY_NODE_HAS]


def topic_types(node: Node, topic: str) -> list[str]:
    """Return the types of a topic, given its full name; none if there is no such topic."""
    return dict(node.get_topic_names_and_types()).get(topic, [])


def services(node: Node, *, include_hidden: bool = False) -> NamesAndTypes:
    """Return the services, sorted by name. Arguments as for `topics`."""
    return _sorted(node.get_service_names_and_types(), include_hidden)


def service_types(node: Node, service: str) -> list[str]:
    """Return the types of a service, given its full name; none if there is no such service."""
    return dict(node.get_service_names_and_types()).get(service, [])


def actions(node: Node, *, include_hidden: bool = False) -> NamesAndTypes:
    """Return the actions, sorted by name. Arguments as for `topics`."""
    return _sorted(get_action_names_and_types(node), include_hidden)


def action_types(node: Node, action: str) -> list[str]:
    """Return the types of an action, given its full name; none if there is no such action."""
    return dict(get_action_names_and_types(node)).get(action, [])


def ends_of_node(node: Node, full_name: str, *, include_hidden: bool = False) -> NodeEnds:
    """Return what a node publishes, subscribes to, offers and calls.

    Args:
        node: The node to ask with. Of its own process it knows all, of others what has come.
        full_name: Full name of the node that is asked about.
        include_hidden: Whether to include hidden topics, services and actions.

    Returns:
        All of it; nothing if there is no such node, or no more.
    """
    whose = split_node_name(full_name)
    try:
        found = (
            node.get_subscriber_names_and_types_by_node(*whose),
            node.get_publisher_names_and_types_by_node(*whose),
            node.get_service_names_and_types_by_node(*whose),
            node.get_client_names_and_types_by_node(*whose),
            get_action_server_names_and_types_by_node(node, *whose),
            get_action_client_names_and_types_by_node(node, *whose),
        )
    except NodeNameNonExistentError:
        return NodeEnds([], [], [], [], [], [])
    return NodeEnds(*(_sorted(ends, include_hidden) for ends in found))


def _sorted(found: NamesAndTypes, include_hidden: bool) -> NamesAndTypes:
    return [
        (name, types) for name, types in sorted(found) if include_hidden or not is_hidden(name)
    ]
