"""Why a subscription hears nothing: the likeliest cause, read off the graph.

A topic that nobody publishes, another type, a QoS profile that does not match, a name that
differs by a letter: ROS says nothing in any of these cases, and each looks the same from inside.
"""

from __future__ import annotations

import difflib
from typing import Any

from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node
from rclpy.qos import QoSCompatibility, QoSProfile, qos_check_compatible
from rclpy.topic_endpoint_info import TopicEndpointInfo

__all__ = [
    'full_topic_name',
    'nearest_name',
    'nobody_publishes',
    'other_type_here',
    'type_name',
    'why_silent',
]


def type_name(msg_type: Any) -> str:
    """Return the ROS name of a message class, such as `std_msgs/msg/String`."""
    package, kind, *_ = msg_type.__module__.split('.')
    return f'{package}/{kind}/{msg_type.__name__}'


def full_topic_name(topic: str, node: Node) -> str:
    """Return a topic's name as the graph knows it: `'odds'` is `/odds` for most nodes."""
    return str(expand_topic_name(topic, node.get_name(), node.get_namespace()))


def why_silent(node: Node, topic: str, msg_type: Any, qos_profile: QoSProfile) -> str:
    """Say in a sentence or two why no message of a topic arrives.

    Args:
        node: The node to ask the graph with.
        topic: The topic that is subscribed to, as a full name.
        msg_type: The type that is subscribed to.
        qos_profile: The QoS profile of the subscription.

    Returns:
        The likeliest cause and what to do. When all is well with the topic: that its publishers
        have published nothing.
    """
    publishers = node.get_publishers_info_by_topic(topic)
    if not publishers:
        return nobody_publishes(node, topic)
    wanted = type_name(msg_type)
    same_type = [info for info in publishers if info.topic_type == wanted]
    if not same_type:
        other = publishers[0]
        return (
            f'{_name(other)} publishes on {topic}, but messages of another type: '
            f'{other.topic_type}, not {wanted}. Use the same type on both sides.'
        )
    for info in same_type:
        # An endpoint reports history and depth as unknown; they play no part in matching.
        compatibility, reason = qos_check_compatible(info.qos_profile, qos_profile)
        if compatibility == QoSCompatibility.ERROR:
            return (
                f'{_name(info)} publishes on {topic}, but its QoS profile does not match the '
                f'subscription: {_readable(reason)} Give both the same qos_profile.'
            )
    names = ', '.join(sorted({_name(info) for info in same_type}))
    return (
        f'{names} has a publisher on {topic} with the right type and QoS, but published nothing '
        'in that time. Is its timer running, and is publish() reached?'
    )


def other_type_here(node: Node, topic: str, msg_type: Any) -> str:
    """Say who in this process uses a topic with another type, '' if nobody does.

    In one process Fast DDS refuses a second type on a topic, with the words "invalid allocator".
    Between processes the same mistake is silent.

    Args:
        node: The node to ask the graph with; no other process has one of its name.
        topic: The topic, as a full name.
        msg_type: The type that was asked for.
    """
    infos = [
        *node.get_publishers_info_by_topic(topic),
        *node.get_subscriptions_info_by_topic(topic),
    ]
    others = [info for info in infos if info.topic_type != type_name(msg_type)]
    # The first 12 bytes of an endpoint's id are those of its DDS participant, and a process has
    # one participant (DDSI-RTPS 2.5, 9.3.1). Every node publishes on this topic.
    everybody = node.get_publishers_info_by_topic('/parameter_events') if others else []
    here = {bytes(i.endpoint_gid[:12]) for i in everybody if i.node_name == node.get_name()}
    for info in others:
        if bytes(info.endpoint_gid[:12]) in here:
            # A check of an exercise may listen from the start of the lesson.
            user = 'labkit' if _is_hidden(_name(info)) else _name(info)
            return (
                f'{user} uses {topic} with messages of another type: {info.topic_type}, '
                f'not {type_name(msg_type)}.'
            )
    return ''


def nobody_publishes(node: Node, topic: str) -> str:
    """Say that a topic has no publisher, and which topic may be meant instead.

    Args:
        node: The node to ask the graph with.
        topic: The topic, as a full name.
    """
    others = {
        name: types
        for name, types in node.get_topic_names_and_types()
        if name != topic and node.count_publishers(name) and not _is_hidden(name)
    }
    near = nearest_name(topic, [name for name in others if name not in _EVERY_NODE_HAS])
    if near and near.rsplit('/', 1)[-1] == topic.rsplit('/', 1)[-1]:
        return (
            f'Nobody publishes on {topic}, but somebody does on {near}: the same name in another '
            'namespace. Names must be equal from the first slash to the last letter.'
        )
    if near:
        return (
            f'Nobody publishes on {topic}, but somebody does on {near}. Is one of the two '
            'misspelt? Capital and small letters differ.'
        )
    return (
        f'Nobody publishes on {topic}. Is the node that should publish there running '
        '(lab.spin), and in the same domain?'
    )


_EVERY_NODE_HAS = ('/rosout', '/parameter_events')


def nearest_name(topic: str, names: list[str]) -> str:
    """Return the name most like `topic`, '' if none is much like it."""
    last = topic.rsplit('/', 1)[-1]
    for name in names:
        if name.rsplit('/', 1)[-1] == last or name.lower() == topic.lower():
            return name
    near = difflib.get_close_matches(topic, names, n=1, cutoff=0.75)
    return near[0] if near else ''


def _is_hidden(name: str) -> bool:
    return any(part.startswith('_') for part in name.split('/'))


def _name(info: TopicEndpointInfo) -> str:
    return f'{info.node_namespace.rstrip("/")}/{info.node_name}'


def _readable(reason: str) -> str:
    """Return what rmw says of two profiles as a sentence."""
    text = reason.removeprefix('ERROR: ').strip().rstrip(';.')
    return f'{text[:1].upper()}{text[1:]}.'
