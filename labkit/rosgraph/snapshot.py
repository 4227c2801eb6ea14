"""A snapshot of the computation graph: nodes, topics, services, and mismatches.

Two snapshots are equal if nothing has changed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from rclpy.node import Node

from labkit.rosgraph.endpoints import Endpoint, publishers, subscriptions
from labkit.rosgraph.listings import actions, ends_of_node, has_ends
from labkit.rosgraph.matching import how_to_match, why_apart
from labkit.rosgraph.names import (
    EVERY_NODE_HAS,
    EVERY_NODE_OFFERS,
    UNKNOWN_NODE,
    full_node_name,
    is_hidden,
)
from labkit.rosgraph.whose import foreign_nodes, has_ended, own_nodes

__all__ = [
    'Graph',
    'GraphAction',
    'GraphNode',
    'GraphService',
    'GraphTopic',
    'Mismatch',
    'is_whole',
    'node_names',
    'read_graph',
]


@dataclass(frozen=True)
class GraphNode:
    """A node.

    Attributes:
        name: Full name, such as `/talker`.
        own: Whether it lives in this process.
        count: Number of nodes with this name. It should be 1.
    """

    name: str
    own: bool
    count: int = 1


@dataclass(frozen=True)
class Mismatch:
    """A publisher and a subscription of one topic that can't communicate.

    Attributes:
        topic: Full name of the topic.
        publisher: Full name of the publishing node.
        subscription: Full name of the subscribing node.
        reason: The cause, as half a sentence.
        todo: The fix at either end.
    """

    topic: str
    publisher: str
    subscription: str
    reason: str
    todo: str = ''


@dataclass(frozen=True)
class GraphTopic:
    """A topic with its publishers and subscriptions."""

    name: str
    types: tuple[str, ...]
    publishers: tuple[Endpoint, ...]
    subscriptions: tuple[Endpoint, ...]

    def mismatches(self) -> Iterator[Mismatch]:
        """Yield the pairs that can't communicate; a pair of nodes once for each reason."""
        seen = set()
        for publisher in self.publishers:
            for subscription in self.subscriptions:
                reason = why_apart(publisher, subscription)
                todo = how_to_match(publisher, subscription)
                mismatch = Mismatch(self.name, publisher.node, subscription.node, reason, todo)
                if reason and mismatch not in seen:
                    seen.add(mismatch)
                    yield mismatch


@dataclass(frozen=True)
class GraphService:
    """A service, with the nodes that offer it and those that have a client.

    Those in `lost` have a client of a type that no server has.
    """

    name: str
    types: tuple[str, ...]
    servers: tuple[str, ...]
    clients: tuple[str, ...]
    lost: tuple[str, ...] = ()


@dataclass(frozen=True)
class GraphAction:
    """An action, with the nodes that serve it and those that have a client, as of a service."""

    name: str
    types: tuple[str, ...]
    servers: tuple[str, ...]
    clients: tuple[str, ...]
    lost: tuple[str, ...] = ()


@dataclass(frozen=True)
class Graph:
    """The nodes, topics, services and actions of a domain at one moment, each sorted by name.

    The topics and services that an action consists of are hidden. `str(graph)` is the graph in
    words.
    """

    nodes: tuple[GraphNode, ...]
    topics: tuple[GraphTopic, ...]
    services: tuple[GraphService, ...] = ()
    actions: tuple[GraphAction, ...] = ()

    @property
    def mismatches(self) -> tuple[Mismatch, ...]:
        """All pairs of a publisher and a subscription that can't communicate."""
        return tuple(mismatch for topic in self.topics for mismatch in topic.mismatches())

    def __str__(self) -> str:
        lines = ['Nodes:', *(f'  {_in_words(node)}' for node in self.nodes), 'Topics:']
        for topic in self.topics:
            lines += [f'  {topic.name} [{", ".join(topic.types)}]']
            lines += _line('published by', [end.node for end in topic.publishers])
            lines += _line('subscribed by', [end.node for end in topic.subscriptions])
            for mismatch in topic.mismatches():
                pair = f'{mismatch.publisher} and {mismatch.subscription}'
                lines += [f'    no match between {pair}: {mismatch.reason}']
        if self.services:
            lines += ['Services:']
        for service in self.services:
            lines += [f'  {service.name} [{", ".join(service.types)}]']
            lines += _line('offered by', service.servers)
            lines += _line('called by', service.clients)
        if self.actions:
            lines += ['Actions:']
        for action in self.actions:
            lines += [f'  {action.name} [{", ".join(action.types)}]']
            lines += _line('served by', action.servers)
            lines += _line('goals from', action.clients)
        return '\n'.join(lines)


def read_graph(
    node: Node,
    *,
    include_hidden: bool = False,
    include_services: bool = False,
    include_actions: bool = True,
) -> Graph:
    """Take a snapshot of the graph.

    Args:
        node: The node to ask with.
        include_hidden: Whether to include hidden nodes and topics, and the topics and parameter
            services that every node has.
        include_services: Whether to include services.
        include_actions: Whether to include actions.
    """
    # A node of another process appears in the graph a moment before its endpoints.
    own = own_nodes(node) - foreign_nodes(node)
    names = [name for name in node_names(node) if include_hidden or not is_hidden(name)]
    nodes = tuple(GraphNode(name, name in own, names.count(name)) for name in sorted(set(names)))
    topics = []
    for topic, types in sorted(node.get_topic_names_and_types()):
        if include_hidden or not (is_hidden(topic) or topic in EVERY_NODE_HAS):
            senders = publishers(node, topic, include_hidden=include_hidden)
            hearers = subscriptions(node, topic, include_hidden=include_hidden)
            if senders or hearers:
                topics += [GraphTopic(topic, tuple(types), senders, hearers)]
    services = _services(node, names, include_hidden) if include_services else ()
    found = _actions(node, names, include_hidden) if include_actions else ()
    return Graph(nodes, tuple(topics), services, found)


def node_names(node: Node) -> list[str]:
    """Return the full names of all nodes, hidden ones too; a name appears once per node.

    ROS's own list can keep an ended node for ever: a participant announces its nodes (topic
    `ros_discovery_info`), and if the last of these messages is read after its goodbye, it is taken
    for a new participant. Such a node has no endpoints and is left out here, as are nodes of
    processes known to have been killed. A live node has endpoints from the start, usually a
    publisher on `/parameter_events`.
    """
    named = Counter(full_node_name(*pair) for pair in node.get_node_names_and_namespaces())
    infos = node.get_publishers_info_by_topic('/parameter_events')
    living, killed = Counter[str](), set()
    for info in infos:
        name = full_node_name(info.node_name, info.node_namespace)
        if has_ended(bytes(info.endpoint_gid)):
            killed.add(name)
        else:
            living[name] += 1
    for name in named.keys() - living.keys() - killed:
        living[name] = named[name] * has_ends(node, name)
    return sorted((named & living).elements())


def is_whole(node: Node) -> bool:
    """Return whether the graph knows the node of every publisher and subscription.

    For other processes that takes a moment longer than the endpoint itself.
    """
    return not any(
        info.node_name == UNKNOWN_NODE
        for topic, _types in node.get_topic_names_and_types()
        for ask in (node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic)
        for info in ask(topic)
    )


def _services(node: Node, names: list[str], include_hidden: bool) -> tuple[GraphService, ...]:
    servers: dict[str, dict[str, list[str]]] = {}
    clients: dict[str, dict[str, list[str]]] = {}
    for full_name in sorted(set(names)):
        found = ends_of_node(node, full_name, include_hidden=True)
        for ends, who in ((found.service_servers, servers), (found.service_clients, clients)):
            for service, types in ends:
                who.setdefault(service, {})[full_name] = types
    return tuple(
        GraphService(
            service,
            tuple(types),
            tuple(servers.get(service, ())),
            tuple(clients.get(service, ())),
            _lost(servers.get(service, {}), clients.get(service, {})),
        )
        for service, types in sorted(node.get_service_names_and_types())
        if include_hidden
        or not (is_hidden(service) or service.rpartition('/')[2] in EVERY_NODE_OFFERS)
    )


def _actions(node: Node, names: list[str], include_hidden: bool) -> tuple[GraphAction, ...]:
    listed = actions(node, include_hidden=include_hidden)
    if not listed:
        return ()
    ends = {name: ends_of_node(node, name, include_hidden=True) for name in sorted(set(names))}
    found = []
    for action, types in listed:
        servers = {n: t for n, e in ends.items() for a, t in e.action_servers if a == action}
        clients = {n: t for n, e in ends.items() for a, t in e.action_clients if a == action}
        if servers or clients:
            lost = _lost(servers, clients)
            found += [GraphAction(action, tuple(types), tuple(servers), tuple(clients), lost)]
    return tuple(found)


def _lost(
    servers: Mapping[str, Iterable[str]], clients: Mapping[str, Iterable[str]]
) -> tuple[str, ...]:
    """Return the clients for whose type there is no server, if there is any server."""
    offered = {msg_type for types in servers.values() for msg_type in types}
    return tuple(name for name, types in clients.items() if offered and not offered >= {*types})


def _in_words(node: GraphNode) -> str:
    notes = [] if node.own else ['another process']
    if node.count > 1:
        notes += [f'{node.count} nodes of this name']
    return f'{node.name} ({", ".join(notes)})' if notes else node.name


def _line(words: str, names: Iterable[str]) -> list[str]:
    text = ', '.join(dict.fromkeys(names))
    return [f'    {words} {text}'] if text else []
