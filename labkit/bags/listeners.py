"""Those who listen already when a bag begins to play: they are to hear its first message."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from rclpy.qos import ReliabilityPolicy

from labkit.background.service_calls import wait_until_spun
from labkit.rosgraph.endpoints import subscriptions
from labkit.rosgraph.matching import qos_mismatch
from labkit.rosgraph.whose import is_own

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.publisher import Publisher

    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['wait_for_listeners']

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
    end, waited_for = time.monotonic() + timeout_sec, set()
    for publisher in publishers:
        found = _matching(node, publisher)
        while publisher.get_subscription_count() < len(found):
            if time.monotonic() >= end or ended():
                return
            time.sleep(POLL_SEC)
            found = _matching(node, publisher)
        waited_for |= {end_.node for end_ in found if _may_lose(node, publisher, end_)}
    for name in sorted(waited_for):
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
    """Tell whether a subscription of another process may lose what comes too early."""
    reliable = ReliabilityPolicy.RELIABLE
    both = publisher.qos_profile.reliability == end.qos.reliability == reliable
    return not both and not is_own(end.gid, node)
