"""A neighbour: a node of another process that hears the chat, and tells what it has heard.

`start_neighbour()` starts it. What it hears on `/shared_chatter` it publishes on
`/heard_next_door`, so that a cell can see what has arrived in another process.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from labkit.lessons._companion import start_companion

if TYPE_CHECKING:
    from labkit.programs.child_processes import Process

__all__ = ['start_neighbour']

HEARS, TELLS = 'shared_chatter', 'heard_next_door'

_process: Process | None = None


def start_neighbour() -> None:
    """Start the neighbour as a process, and wait until it is there and tells what it hears.

    One that is there already is ended first. `lab.processes()` lists and stops it.

    Raises:
        LabTimeout: It did not come.
    """
    global _process
    _process = start_companion('neighbour', __name__, _process)
    print('The neighbour is there: a node in a process of its own.')


def main() -> None:
    """Be the neighbour until interrupted."""
    import rclpy
    from rclpy.node import Node
    from std_msgs.msg import String

    from labkit.programs.program import publish_when_heard, spin_until_interrupted

    rclpy.init()
    node = Node('neighbour', start_parameter_services=False)
    publisher = node.create_publisher(String, TELLS, 100)
    node.create_subscription(String, HEARS, lambda msg: publish_when_heard(publisher, msg), 100)
    spin_until_interrupted(node)
