"""Publishers and subscriptions of the graph as data."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.topic_endpoint_info import TopicEndpointInfo

from labkit.errors import printable
from labkit.rosgraph.names import UNKNOWN_NODE, full_node_name, is_hidden
from labkit.rosgraph.whose import has_ended

__all__ = ['Endpoint', 'publishers', 'subscriptions']


@dataclass(frozen=True)
class Endpoint:
    """A publisher or a subscription.

    Two that differ only in their GUID are equal: a cell that was run again has recreated its
    endpoint.

    Attributes:
        node: Full name of its node, see `is_known`.
        topic: Full name of its topic.
        msg_type: Name of the type, such as `std_msgs/msg/String`.
        qos: QoS profile. History and depth are unknown to the graph.
        gid: Its GUID, 16 bytes; see `labkit.rosgraph.whose`.
        type_hash: Hash of the definition of its type, '' if it is not known.
    """

    node: str
    topic: str
    msg_type: str
    qos: QoSProfile
    gid: bytes = field(compare=False)
    type_hash: str = field(compare=False, default='')

    @property
    def is_known(self) -> bool:
        """Whether the graph knows its node, which takes a moment longer than the endpoint."""
        return UNKNOWN_NODE not in self.node


def publishers(node: Node, topic: str, *, include_hidden: bool = True) -> tuple[Endpoint, ...]:
    """Return the publishers of a topic, sorted by node and type.

    Args:
        node: The node to ask with.
        topic: Full name of the topic.
        include_hidden: Whether to include publishers of hidden nodes.
    """
    return _sorted(topic, node.get_publishers_info_by_topic(topic), include_hidden)


def subscriptions(node: Node, topic: str, *, include_hidden: bool = True) -> tuple[Endpoint, ...]:
    """Return the subscriptions to a topic. Arguments as for `publishers`."""
    return _sorted(topic, node.get_subscriptions_info_by_topic(topic), include_hidden)


def _hash(info: TopicEndpointInfo) -> str:
    known = info.topic_type_hash
    return str(known) if known is not None and known.version > 0 else ''


def _sorted(
    topic: str, infos: Iterable[TopicEndpointInfo], include_hidden: bool
) -> tuple[Endpoint, ...]:
    found = [
        Endpoint(
            printable(full_node_name(info.node_name, info.node_namespace)),
            topic,
            printable(info.topic_type),
            info.qos_profile,
            bytes(info.endpoint_gid),
            _hash(info),
        )
        for info in infos
        if not has_ended(bytes(info.endpoint_gid))
    ]
    shown = [end for end in found if include_hidden or not is_hidden(end.node)]
    return tuple(sorted(shown, key=lambda end: (end.node, end.msg_type)))
