"""Deliver the first and the last message of a publisher to all subscriptions."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import ReliabilityPolicy

from labkit.asking.service_calls import wait_until_spun
from labkit.background.wait import wait_for
from labkit.rosgraph.endpoints import Endpoint, subscriptions
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.matching import qos_mismatch
from labkit.rosgraph.whose import is_own

__all__ = ['MATCH_SEC', 'wait_until_found', 'wait_until_taken']

# How long a subscription in the graph may take to discover a publisher.
MATCH_SEC = 2.0
# A best effort subscription of a node without parameter services, as a view has it, can't be asked
# whether it has discovered the publisher. It takes less than this, s.
FOUND_SEC = 0.5


def wait_until_found(
    node: Node,
    publishers: Iterable[Publisher],
    timeout_sec: float = MATCH_SEC,
    *,
    ended: Callable[[], bool] = lambda: False,
) -> None:
    """Wait until existing subscriptions have discovered some publishers.

    A publisher discovers a subscription before the subscription discovers the publisher, and best
    effort loses messages in between. But discovery keeps the order of creation: a process that
    answers a client of this node knows the publishers that were made before the client.

    Args:
        node: A node of the publishers' context.
        publishers: The publishers.
        timeout_sec: Seconds to wait at most: some nodes never answer.
        ended: Returns whether to wait no longer.
    """
    end, published = time.monotonic() + timeout_sec, list(publishers)

    def all_matched() -> bool:
        return all(
            publisher.get_subscription_count() >= len(_matching(node, publisher))
            for publisher in published
        )

    wait_for(lambda: all_matched() or ended(), timeout_sec)
    _wait_for_answers(node, published, end, ended)


def wait_until_taken(
    node: Node,
    publishers: Iterable[Publisher],
    timeout_sec: float,
    *,
    ended: Callable[[], bool] = lambda: False,
) -> None:
    """Wait until subscriptions of other processes have received what was published.

    Reliable ones acknowledge it, and request what they missed. Best effort does not, and drops
    messages on their way if the end of the publisher arrives first. But a request takes the same
    way as messages: a node that answers one has the messages that were sent before it.

    Args:
        node: A node of the publishers' context.
        publishers: The publishers.
        timeout_sec: Seconds to wait at most, for acknowledgements and for answers.
        ended: Returns whether to wait no longer.
    """
    now, published = Duration(), list(publishers)

    def all_acknowledged() -> bool:
        return all(publisher.wait_for_all_acked(now) for publisher in published)

    wait_for(lambda: all_acknowledged() or ended(), timeout_sec)
    _wait_for_answers(node, published, time.monotonic() + timeout_sec, ended)


def _wait_for_answers(
    node: Node, publishers: Iterable[Publisher], end: float, ended: Callable[[], bool]
) -> None:
    """Wait at most until `end` for an answer of each node that may lose messages."""
    services = dict(node.get_service_names_and_types())
    names = {
        listener.node
        for publisher in publishers
        for listener in _matching(node, publisher)
        if _may_lose(node, publisher, listener)
    }
    for name in sorted(names):
        left = end - time.monotonic()
        if left > 0 and not ended():
            wait_until_spun(node, name, left)
    if not all(f'{name}/list_parameters' in services for name in names):
        wait_for(ended, min(FOUND_SEC, max(0.0, end - time.monotonic())))


def _matching(node: Node, publisher: Publisher) -> list[Endpoint]:
    """Return the subscriptions in the graph that match a publisher."""
    offered, msg_type = publisher.qos_profile, type_name(publisher.msg_type)
    return [
        end
        for end in subscriptions(node, publisher.topic_name)
        if end.msg_type == msg_type and not qos_mismatch(offered, end.qos)
    ]


def _may_lose(node: Node, publisher: Publisher, end: Endpoint) -> bool:
    """Return whether a subscription is in another process and not reliable on both sides."""
    reliable = ReliabilityPolicy.RELIABLE
    both = publisher.qos_profile.reliability == end.qos.reliability == reliable
    return not both and not is_own(end.gid, node)
