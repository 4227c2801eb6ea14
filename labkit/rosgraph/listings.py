"""Topics, services and actions by name and type, and those of one node."""

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

from labkit.errors import printable
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
"""Full names, each with the types in use."""

# Suffixes of an action's feedback topic and of its type.
_FEEDBACK = '/_action/feedback'
_FEEDBACK_TYPE = '_FeedbackMessage'


@dataclass(frozen=True)
class NodeEnds:
    """The endpoints of a node, sorted by name."""

    subscribers: NamesAndTypes
    publishers: NamesAndTypes
    service_servers: NamesAndTypes
    service_clients: NamesAndTypes
    action_servers: NamesAndTypes
    action_clients: NamesAndTypes

    def names(self) -> dict[str, list[str]]:
        """Return the names, by kind."""
        return {kind: [name for name, _types in found] for kind, found in vars(self).items()}


def topics(node: Node, *, include_hidden: bool = False) -> NamesAndTypes:
    """Return the topics, sorted by name."""
    return _sorted(node.get_topic_names_and_types(), include_hidden)


def own_topics(node: Node) -> list[str]:
    """Return the names of the topics that were created on purpose."""
    return [name for name, _ in topics(node) if name not in EVERY_NODE_HAS]


def topic_types(node: Node, topic: str) -> list[str]:
    """Return the types of a topic; none if there is no such topic."""
    return _printable(dict(node.get_topic_names_and_types()).get(topic, []))


def services(node: Node, *, include_hidden: bool = False) -> NamesAndTypes:
    """Return the services, sorted by name. Arguments as for `topics`."""
    return _sorted(node.get_service_names_and_types(), include_hidden)


def service_types(node: Node, service: str) -> list[str]:
    """Return the types of a service; none if there is no such service."""
    return _printable(dict(node.get_service_names_and_types()).get(service, []))


def actions(node: Node, *, include_hidden: bool = False) -> NamesAndTypes:
    """Return the actions, sorted by name. Arguments as for `topics`."""
    return _sorted(get_action_names_and_types(node), include_hidden)


def action_types(node: Node, action: str) -> list[str]:
    """Return the types of an action; none if there is no such action."""
    return _printable(dict(get_action_names_and_types(node)).get(action, []))


def ends_of_node(node: Node, full_name: str, *, include_hidden: bool = False) -> NodeEnds:
    """Return the endpoints of a node.

    Args:
        node: The node to ask with. Its knowledge of other processes may lag.
        full_name: Full name of the node in question.
        include_hidden: Whether to include hidden topics, services and actions.

    Returns:
        The endpoints; none if the node does not exist, or has ended.
    """
    found = _ends_as_listed(node, full_name)
    if not any(found):
        # ROS may mean one that has ended, while another one of the same name lives.
        found = _ends_as_seen(node, full_name)
    return NodeEnds(*(_sorted(ends, include_hidden) for ends in found))


def has_ends(node: Node, full_name: str) -> bool:
    """Return whether ROS lists any endpoint of a node, hidden or not.

    Args:
        node: The node to ask with.
        full_name: Full name of the node in question.
    """
    return any(_ends_as_listed(node, full_name))


def _ends_as_listed(node: Node, full_name: str) -> tuple[NamesAndTypes, ...]:
    """Return the endpoints that ROS lists of a node, in the order of `NodeEnds`.

    Of several nodes with one name it picks one, possibly one that has ended: see `node_names`.
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
    """Return the endpoints of a node from a scan of the whole graph, which takes longer.

    A service is a topic of requests and one of responses (design.ros2.org, "Topic and Service name
    mapping to DDS"); an action has, among others, a feedback topic.
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
        (printable(name), _printable(types))
        for name, types in sorted(found)
        if include_hidden or not is_hidden(name)
    ]


def _printable(types: Iterable[str]) -> list[str]:
    """Return names of types without what moves a terminal: others may announce any text."""
    return [printable(name) for name in types]
