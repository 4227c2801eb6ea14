"""Why two endpoints of a topic do not match, and why a subscription gets nothing.

A topic without publishers, another type, an incompatible QoS profile, a name that differs by one
letter: ROS is silent in all of these cases, and they all look the same from inside.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
)

from labkit.errors import nearest
from labkit.rosgraph.endpoints import Endpoint, publishers, subscriptions
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.names import EVERY_NODE_HAS, is_hidden
from labkit.rosgraph.whose import is_own

__all__ = [
    'how_to_match',
    'nobody_publishes',
    'other_type_here',
    'qos_mismatch',
    'who_subscribes',
    'why_apart',
    'why_deaf',
]

# From here on a duration means infinity: the largest one is 2^63 - 1 ns, and the middleware may
# return a slightly smaller one.
_INFINITE_NS = 2**62


def qos_mismatch(offered: QoSProfile, requested: QoSProfile) -> str:
    """Return why two QoS profiles are incompatible, as half a sentence; '' if they match.

    Args:
        offered: Profile of a publisher.
        requested: Profile of a subscription. History and depth, which the graph does not report,
            play no part.
    """
    compatibility, reason = qos_check_compatible(
        _without_infinity(offered), _without_infinity(requested)
    )
    if compatibility != QoSCompatibility.ERROR:
        return ''
    parts = [part.removeprefix('ERROR: ').strip(' .') for part in str(reason).split(';')]
    first, *others = filter(None, parts)
    return '; '.join([first, *(f'{other[:1].lower()}{other[1:]}' for other in others)])


def why_apart(publisher: Endpoint, subscription: Endpoint) -> str:
    """Return why two endpoints of a topic do not match, as half a sentence; '' if they do."""
    if publisher.msg_type != subscription.msg_type:
        return f'{publisher.msg_type} is not {subscription.msg_type}'
    return qos_mismatch(publisher.qos, subscription.qos)


def how_to_match(publisher: Endpoint, subscription: Endpoint) -> str:
    """Return what to change at either end so that the two match, '' if they do.

    A subscription requests, a publisher offers: each policy can be fixed at either end.
    """
    mine, yours = f'the subscription of {subscription.node}', f'the publisher of {publisher.node}'
    if publisher.msg_type != subscription.msg_type:
        return f'Give {mine} and {yours} the same type.'
    asked, offered = subscription.qos, publisher.qos
    said = []
    for policy, strong, weak in (
        ('reliability', ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT),
        ('durability', DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE),
        ('liveliness', LivelinessPolicy.MANUAL_BY_TOPIC, LivelinessPolicy.AUTOMATIC),
    ):
        if (getattr(asked, policy), getattr(offered, policy)) == (strong, weak):
            said += [f'Give {mine} {policy} {weak.name}, or {yours} {strong.name}.']
    for policy in ('deadline', 'liveliness_lease_duration'):
        wanted, given = getattr(asked, policy), getattr(offered, policy)
        if not _is_infinite(wanted) and (_is_infinite(given) or wanted < given):
            limit = f'{yours} one of {_seconds(wanted)} at most'
            name = policy.replace('_', ' ')
            said += [
                f'Take the {name} of {mine} away, or give {limit}.'
                if _is_infinite(given)
                else f'Give {mine} a {name} of {_seconds(given)} at least, or {limit}.'
            ]
    return ' '.join(said)


def _without_infinity(profile: QoSProfile) -> QoSProfile:
    """Return a profile in which infinite durations are unset.

    The graph reports unset ones as infinite, which would be described as a deadline that is too
    long.
    """
    plain = copy.copy(profile)
    for policy in ('deadline', 'liveliness_lease_duration'):
        if _is_infinite(getattr(plain, policy)):
            setattr(plain, policy, Duration())
    return plain


def _is_infinite(duration: Duration) -> bool:
    return not 0 < duration.nanoseconds < _INFINITE_NS


def _seconds(duration: Duration) -> str:
    return f'{duration.nanoseconds * 1e-9:g} s'


def why_deaf(node: Node, topic: str, msg_type: Any, qos_profile: QoSProfile) -> str:
    """Return in a sentence or two why a subscription hears no publisher, '' if it hears one.

    Args:
        node: The node to ask the graph with.
        topic: Full name of the subscribed topic.
        msg_type: Type of the subscription.
        qos_profile: QoS profile of the subscription.
    """
    found = publishers(node, topic)
    if not found:
        return nobody_publishes(node, topic)
    wanted = type_name(msg_type)
    same_type = [end for end in found if end.msg_type == wanted]
    if not same_type:
        return (
            f'{found[0].node} publishes on {topic}, but messages of another type: '
            f'{found[0].msg_type}, not {wanted}. Use the same type on both sides.'
        )
    for end in same_type:
        reason = qos_mismatch(end.qos, qos_profile)
        if reason:
            return (
                f'{end.node} publishes on {topic}, but its QoS profile does not match the '
                f'subscription: {reason[:1].upper()}{reason[1:]}. Give both the same qos_profile.'
            )
    return _hears_nothing_earlier(same_type, qos_profile)


def _hears_nothing_earlier(found: Sequence[Endpoint], qos_profile: QoSProfile) -> str:
    """Return why a subscription that asks for earlier messages gets none, '' if it would."""
    keeping = ReliabilityPolicy.RELIABLE, DurabilityPolicy.TRANSIENT_LOCAL
    for end in found:
        if (
            qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
            and qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT
            and (end.qos.reliability, end.qos.durability) == keeping
        ):
            return (
                f'{end.node} publishes on {end.topic} and keeps its last messages, but a '
                'subscription that is BEST_EFFORT gets only new ones, and none came in that time. '
                'Ask for the reliability RELIABLE, too.'
            )
    return ''


def who_subscribes(node: Node, topic: str, msg_type: Any, qos_profile: QoSProfile) -> str:
    """Return why a publisher has too few subscribers.

    Args:
        node: The node to ask the graph with.
        topic: Full name of the topic.
        msg_type: Type of the publisher.
        qos_profile: QoS profile of the publisher.
    """
    found = subscriptions(node, topic)
    wanted = type_name(msg_type)
    for end in found:
        if end.msg_type != wanted:
            return f'{end.node} subscribes to {topic}, but to {end.msg_type}, not {wanted}.'
        reason = qos_mismatch(qos_profile, end.qos)
        if reason:
            return (
                f'{end.node} subscribes to {topic}, but its QoS profile does not match: {reason}.'
            )
    names = [
        name
        for name, _ in node.get_topic_names_and_types()
        if name != topic and node.count_subscribers(name)
    ]
    near = nearest(topic, names)
    if near:
        return f'Somebody subscribes to {near}. Is one of the two names misspelt?'
    return f'{"Too few nodes subscribe" if found else "Nobody subscribes"} to {topic}.'


def other_type_here(node: Node, topic: str, msg_type: Any) -> str:
    """Return who in this process uses a topic with another type, '' if nobody does.

    Within one process Fast DDS refuses a second type on a topic with the words "invalid
    allocator". Between processes the same mistake is silent.

    Args:
        node: A node of this process, to ask the graph with.
        topic: Full name of the topic.
        msg_type: The requested type.
    """
    wanted = type_name(msg_type)
    for end in (*publishers(node, topic), *subscriptions(node, topic)):
        if end.msg_type != wanted and is_own(end.gid, node):
            # A check of an exercise may be subscribed from the start of the lesson.
            user = 'labkit' if is_hidden(end.node) else end.node
            return (
                f'{user} uses {topic} with messages of another type: {end.msg_type}, not {wanted}.'
            )
    return ''


def nobody_publishes(node: Node, topic: str) -> str:
    """Return that a topic has no publisher, and which similar topic has one."""
    others = [
        name
        for name, _ in node.get_topic_names_and_types()
        if name not in (topic, *EVERY_NODE_HAS)
        and not is_hidden(name)
        and node.count_publishers(name)
    ]
    near = nearest(topic, others)
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
