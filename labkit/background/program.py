"""What a program does that consists of nodes, and is a process of its own."""

from __future__ import annotations

import contextlib
import json
import os
import time
from typing import Any

from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.utilities import ok, try_shutdown

from labkit.rosgraph.listings import ends_of_node

__all__ = ['READY', 'publish_when_heard', 'spin_until_interrupted']

READY = 'LABKIT_READY'
"""Variable with the number of a pipe: what is written to it is read by `Process.announced`."""

# How long an answer waits for somebody to hear it, s.
FOUND_SEC, POLL_SEC = 5.0, 0.005


def spin_until_interrupted(*nodes: Node) -> None:
    """Spin nodes until Ctrl-C or until ROS is shut down, then end ROS.

    At Ctrl-C a thread of rclpy shuts ROS down, at any moment: a callback that wants to publish
    then can't, and a second shutdown in the same moment is refused. Neither is a fault.

    Args:
        nodes: The nodes. They are not destroyed; that happens when the process ends.
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


def publish_when_heard(publisher: Publisher, message: Any, count: int = 1) -> None:
    """Publish an answer as soon as the one who asks can hear it.

    A publisher and a subscription of the same node are discovered one by one. So who asks may be
    heard before it can hear, and what is published then does not come to it.

    Args:
        publisher: The publisher.
        message: The answer.
        count: How many subscriptions there are then, with those of the program itself.
    """
    end = time.monotonic() + FOUND_SEC
    while publisher.get_subscription_count() < count and time.monotonic() < end:
        time.sleep(POLL_SEC)
    publisher.publish(message)


def _announce(nodes: tuple[Node, ...]) -> None:
    """Say what the nodes have, if somebody waits for it; in the graph it comes piece by piece."""
    pipe = os.environ.pop(READY, '')
    if not pipe.isdecimal():
        return
    ends = {}
    for node in nodes:
        name = node.get_fully_qualified_name()
        ends[name] = ends_of_node(node, name, include_hidden=True).names()
    with contextlib.suppress(OSError), open(int(pipe), 'w', encoding='utf-8') as file:
        json.dump(ends, file)
