"""Helpers for programs of nodes that run in their own process."""

from __future__ import annotations

import contextlib
import json
import os
from typing import Any

from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.utilities import ok, try_shutdown

from labkit.background.wait import wait_for
from labkit.programs.child_environment import READY
from labkit.rosgraph.listings import ends_of_node

__all__ = ['publish_when_heard', 'spin_until_interrupted']

# How long an answer waits for a subscription, s.
FOUND_SEC = 5.0


def spin_until_interrupted(*nodes: Node) -> None:
    """Spin nodes until Ctrl-C or until ROS is shut down, then end ROS.

    At Ctrl-C a thread of rclpy shuts ROS down at any moment: publishing in a callback then fails,
    and so does a second shutdown at the same moment. Neither is an error. The nodes are not
    destroyed until the process ends.
    """
    executor = SingleThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    try:
        _announce(nodes)
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except RuntimeError:  # RCLError has no public name
        if ok():
            raise
    finally:
        with contextlib.suppress(RuntimeError):
            try_shutdown()


def publish_when_heard(
    publisher: Publisher, message: Any, count: int = 1, timeout_sec: float = FOUND_SEC
) -> None:
    """Publish an answer as soon as the node that asked can receive it.

    The publisher and the subscription of a node are discovered one by one, so a question may
    arrive before its sender can receive an answer.

    Args:
        publisher: The publisher.
        message: The answer.
        count: Number of subscriptions to wait for, including the program's own.
        timeout_sec: Seconds to wait; it is published then anyway.
    """
    wait_for(lambda: publisher.get_subscription_count() >= count, timeout_sec)
    publisher.publish(message)


def _announce(nodes: tuple[Node, ...]) -> None:
    """Announce the endpoints of complete nodes, which appear in the graph one by one."""
    pipe = os.environ.pop(READY, '')
    if not pipe.isdecimal():
        return
    ends = {}
    for node in nodes:
        name = node.get_fully_qualified_name()
        ends[name] = ends_of_node(node, name, include_hidden=True).names()
    with contextlib.suppress(OSError), open(int(pipe), 'w', encoding='utf-8') as file:
        json.dump(ends, file)
