"""What a program does that consists of nodes, and is a process of its own."""

from __future__ import annotations

import contextlib

from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.utilities import ok, try_shutdown

__all__ = ['spin_until_interrupted']


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
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except RuntimeError:  # RCLError has no public name
        if ok():
            raise
    finally:
        with contextlib.suppress(RuntimeError):
            try_shutdown()
