"""Topics and services by name and type, and what one node has of them, actions included."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rclpy.action.graph import (
    get_action_client_names_and_types_by_node,
    get_action_names_and_types,
    get_action_server_names_and_types_by_node,
)
from rclpy.node import Node, NodeNameNonExistentError
from rclpy.topic_endpoint_info import TopicEndpointInfo

from labkit.rosgraph.names import EVERY_NODE_HAS, full_node_name, is_hidden, split_node_name

__all__ = [
    'NamesAndTypes',
    'NodeEnds',
    'action_types',
    'actions',
    'ends_of_node',
    'has_ends',
    'own_topics',
    'service_types',
    'services',
    'topic_types',
    'topics',
]

NamesAndTypes = list[tuple[str, list[str]]]
"""Full names, each with the types that are in use there."""

# What an action's topic of feedback and its type are called after those of the action.
_FEEDBACK = '/_action/feedback'
_FEEDBACK_TYPE = '_FeedbackMessage'


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
    found = _ends_as_listed(node, full_name)
    if not any(found):
        # The one that ROS speaks of may have ended, while another one of that name lives.
        found = _ends_as_seen(node, full_name)
    return NodeEnds(*(_sorted(ends, include_hidden) for ends in found))


def has_ends(node: Node, full_name: str) -> bool:
    """Tell whether ROS lists anything that a node has, hidden or not.

    Args:
        node: The node to ask with.
        full_name: Full name of the node that is asked about.
    """
    return any(_ends_as_listed(node, full_name))


def _ends_as_listed(node: Node, full_name: str) -> tuple[NamesAndTypes, ...]:
    """Return what ROS lists of a node, in the order of `NodeEnds`.

    Of nodes of one name it speaks of one, and that may be one that has ended: see `node_names`.
    """
    whose = split_node_name(full_name)
    try:
        return (
            node.get_subscriber_names_and_types_by_node(*whose),
            node.get_publisher_names_and_types_by_node(*whose),
            node.get_service_names_and_types_by_node(*whose),
            node.get_client_names_and_types_by_node(*whose),
            get_action_server_names_and_types_by_node(node, *whose),
            get_action_client_names_and_types_by_node(node, *whose),
        )
    except NodeNameNonExistentError:
        return ()


def _ends_as_seen(node: Node, full_name: str) -> tuple[NamesAndTypes, ...]:
    """Return what is found of a node by looking at all ends in the graph, which takes longer.

    A service is a topic of requests and one of answers (design.ros2.org, "Topic and Service name
    mapping to DDS"); an action has a topic of feedback, among others.
    """
    heard, sent = node.get_subscriptions_info_by_topic, node.get_publishers_info_by_topic

    def its_types(infos: Iterable[TopicEndpointInfo]) -> list[str]:
        mine = (i for i in infos if full_node_name(i.node_name, i.node_namespace) == full_name)
        return sorted({info.topic_type for info in mine})

    def of_actions(ends: NamesAndTypes) -> NamesAndTypes:
        return [
            (name.removesuffix(_FEEDBACK), [type_.removesuffix(_FEEDBACK_TYPE) for type_ in types])
            for name, types in ends
            if name.endswith(_FEEDBACK)
        ]

    subscribers, publishers = (
        [
            (name, types)
            for name, _ in node.get_topic_names_and_types()
            if (types := its_types(ask(name)))
        ]
        for ask in (heard, sent)
    )
    servers, clients = (
        [
            (name, types)
            for name, types in node.get_service_names_and_types()
            if its_types(ask(f'rq{name}Request', no_mangle=True))
        ]
        for ask in (heard, sent)
    )
    actions = of_actions(publishers), of_actions(subscribers)
    return subscribers, publishers, servers, clients, *actions


def _sorted(found: NamesAndTypes, include_hidden: bool) -> NamesAndTypes:
    return [
        (name, types) for name, types in sorted(found) if include_hidden or not is_hidden(name)
    ]
