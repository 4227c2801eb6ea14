"""Those who listen when a bag is played: they are to hear its first message, and its last."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from rclpy.duration import Duration
from rclpy.qos import ReliabilityPolicy

from labkit.background.service_calls import wait_until_spun
from labkit.rosgraph.endpoints import subscriptions
from labkit.rosgraph.matching import qos_mismatch
from labkit.rosgraph.whose import is_own

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.publisher import Publisher

    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['wait_for_listeners', 'wait_until_heard']

POLL_SEC = 0.01


def wait_for_listeners(
    node: Node, publishers: Iterable[Publisher], timeout_sec: float, ended: Callable[[], bool]
) -> None:
    """Wait until those who subscribe already hear some publishers.

    A publisher finds a subscription before that has found the publisher, and what is published in
    between is lost to best effort. But a process takes what is new in the order in which it was
    made: one that answers a client of this node knows the publishers that were made before.

    Args:
        node: Their node.
        publishers: The publishers.
        timeout_sec: Seconds to wait at most: some nodes never answer.
        ended: Whether to wait no longer.
    """
    end, published = time.monotonic() + timeout_sec, list(publishers)
    for publisher in published:
        found = _matching(node, publisher)
        while publisher.get_subscription_count() < len(found):
            if time.monotonic() >= end or ended():
                return
            time.sleep(POLL_SEC)
            found = _matching(node, publisher)
    _wait_for_answers(node, published, end, ended)


def wait_until_heard(
    node: Node, publishers: Iterable[Publisher], timeout_sec: float, ended: Callable[[], bool]
) -> None:
    """Wait until what was published has come to those who subscribe in other processes.

    Reliable ones say so. Best effort does not, and what is still on its way is thrown away where
    the end of its publisher is known first. But a request goes the same way as the messages: who
    answers one has the messages that were sent before it.

    Args:
        node: Their node.
        publishers: The publishers.
        timeout_sec: Seconds to wait at most, for a publisher and for answers.
        ended: Whether to wait no longer.
    """
    published = list(publishers)
    for publisher in published:
        if not ended():
            publisher.wait_for_all_acked(Duration(seconds=timeout_sec))
    _wait_for_answers(node, published, time.monotonic() + timeout_sec, ended)


def _wait_for_answers(
    node: Node, publishers: Iterable[Publisher], end: float, ended: Callable[[], bool]
) -> None:
    """Wait, until a time, for an answer of each node that may lose something."""
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


def _matching(node: Node, publisher: Publisher) -> list[Endpoint]:
    """Return the subscriptions in the graph that are to hear a publisher."""
    offered = publisher.qos_profile
    return [
        end
        for end in subscriptions(node, publisher.topic_name)
        if not qos_mismatch(offered, end.qos)
    ]


def _may_lose(node: Node, publisher: Publisher, end: Endpoint) -> bool:
    """Tell whether a subscription of another process may lose what comes at a wrong moment."""
    reliable = ReliabilityPolicy.RELIABLE
    both = publisher.qos_profile.reliability == end.qos.reliability == reliable
    return not both and not is_own(end.gid, node)
