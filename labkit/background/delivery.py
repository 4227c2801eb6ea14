"""Waiting until a message that is published once reaches all who are there."""

from __future__ import annotations

import time

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import ReliabilityPolicy

from labkit.background.discovery import soon
from labkit.rosgraph.endpoints import subscriptions
from labkit.rosgraph.interfaces import type_name

__all__ = ['MATCH_SEC', 'wait_for_known', 'wait_until_taken']

# As long as that, a subscriber that the graph knows may take to match.
MATCH_SEC = 1.0
# As long as that, a best effort subscriber may take to find a publisher that has found it.
FOUND_SEC = 0.5
# As long as that, a subscriber that has matched may take to get what was sent.
TAKEN_SEC = 5.0
# Short, so that the stop button is heard.
STEP_SEC = 0.01


def wait_for_known(node: Node, publisher: Publisher) -> None:
    """Wait a moment, so that a message sent once reaches all who are there, not one only.

    Args:
        node: The node to ask the graph with.
        publisher: Who is going to publish.
    """
    wanted = type_name(publisher.msg_type)
    ends = subscriptions(node, publisher.topic_name)
    known = [end.qos.reliability for end in ends if end.msg_type == wanted]
    soon(lambda: publisher.get_subscription_count() >= len(known), MATCH_SEC)
    if ReliabilityPolicy.BEST_EFFORT in known:
        # It has to find the publisher too, and does not ask for what it has missed.
        time.sleep(FOUND_SEC)


def wait_until_taken(publisher: Publisher) -> None:
    """Wait a moment for reliable subscribers that have not got everything yet.

    One that has only just found the publisher asks for what it missed. A publisher that has ended
    by then can't repeat it, and the only message would be lost.
    """
    step = Duration(nanoseconds=int(STEP_SEC * 1e9))
    end = time.monotonic() + TAKEN_SEC
    while not publisher.wait_for_all_acked(step) and time.monotonic() < end:
        pass
