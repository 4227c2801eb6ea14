"""A program with a fault in it: a referee, five gates, and one gate that counts in another type.

`open_stadium()` starts it as a process of its own. Within one process ROS refuses a second type
on a topic; between processes the mistake is silent, and that is what is to be seen.
"""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from labkit.lessons._companion import start_companion

if TYPE_CHECKING:
    from labkit.programs.child_processes import Process

__all__ = ['GATES', 'GOALS', 'NODES', 'VISITORS', 'open_stadium', 'wrong_gates']

GOALS = '/goals'
VISITORS = '/visitors'
RIGHT_TYPE = 'std_msgs/msg/Int16'
GATES = ('/gate_a', '/gate_b', '/gate_c', '/gate_d', '/gate_e')
NODES = ('/referee', *GATES)

PERIOD_SEC = 0.1

_process: Process | None = None


def open_stadium() -> None:
    """Start the stadium as a process, and wait until its nodes are in the graph.

    One that is open already is closed first, and its nodes leave the graph. `lab.processes()`
    lists and stops it.

    Raises:
        LabTimeout: Its nodes did not come.
    """
    global _process
    _process = start_companion('stadium', __name__, _process)


def wrong_gates() -> list[str]:
    """Return the names of the gates whose type is not that of the others, read off the graph.

    None if the stadium is closed. Only the one that is open counts: a gate of an earlier one that
    was killed stays in the graph for a while.
    """
    from labkit.background.runtime import runtime

    if _process is None or not _process.running or runtime.helper is None:
        return []
    gates = {
        f'/{info.node_name}': info.topic_type
        for info in runtime.helper.get_publishers_info_by_topic(VISITORS)
        if _process.owns(bytes(info.endpoint_gid))
    }
    return [name for name in GATES if gates.get(name, RIGHT_TYPE) != RIGHT_TYPE]


def main() -> None:
    """Publish until it is interrupted."""
    import rclpy
    from rclpy.context import Context
    from rclpy.node import Node
    from rclpy.publisher import Publisher
    from rclpy.utilities import get_default_context
    from std_msgs.msg import Int16, Int32

    from labkit.programs.program import spin_until_interrupted

    # A context has a DDS participant of its own, and each can have its own type for a topic.
    right, wrong = get_default_context(), Context()
    nodes, publishers = [], list[tuple[Publisher, type]]()

    def add(name: str, topic: str, msg_type: type, context: Context) -> None:
        nodes.append(Node(name.lstrip('/'), context=context, start_parameter_services=False))
        publishers.append((nodes[-1].create_publisher(msg_type, topic, 10), msg_type))

    for context in (right, wrong):
        rclpy.init(context=context)
    add('referee', GOALS, Int16, right)
    culprit = random.choice(GATES)
    for gate in GATES:
        add(gate, VISITORS, *((Int32, wrong) if gate == culprit else (Int16, right)))
    number = 0

    def publish() -> None:
        nonlocal number
        for publisher, msg_type in publishers:
            publisher.publish(msg_type(data=number // 10 % 1000))
        number += 1

    nodes[0].create_timer(PERIOD_SEC, publish)
    spin_until_interrupted(*nodes)
