"""What a program does that consists of nodes, and is a process of its own."""

from __future__ import annotations

import contextlib
import json
import os

from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.utilities import ok, try_shutdown

from labkit.rosgraph.listings import ends_of_node

__all__ = ['READY', 'spin_until_interrupted']

READY = 'LABKIT_READY'
"""Variable with the number of a pipe: what is written to it is read by `Process.announced`."""


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
