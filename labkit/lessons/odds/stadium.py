"""A program with a fault in it: a referee, five gates, and one gate that counts in another type.

`open_stadium()` starts it as a process of its own. Within one process ROS refuses a second type
on a topic; between processes the mistake is silent, and that is what is to be seen.
"""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time

from labkit.errors import LabTimeout

__all__ = ['GATES', 'GOALS', 'NODES', 'VISITORS', 'open_stadium', 'wrong_gates']

GOALS = '/goals'
VISITORS = '/visitors'
RIGHT_TYPE = 'std_msgs/msg/Int16'
GATES = ('/gate_a', '/gate_b', '/gate_c', '/gate_d', '/gate_e')
NODES = ('/referee', *GATES)

PERIOD_SEC = 0.1
START_SEC = 25.0

_process: subprocess.Popen[bytes] | None = None


def open_stadium() -> None:
    """Start the stadium as a process, and wait until its nodes are in the graph.

    One that is open already is closed first. It closes by itself when this program ends.

    Raises:
        LabTimeout: Its nodes did not come.
    """
    global _process
    from labkit.background.runtime import runtime

    close_stadium()
    runtime.start()
    program = f'from {__name__} import main; main()'
    # In a session of its own: the stop button interrupts all processes of the kernel's session.
    _process = subprocess.Popen([sys.executable, '-c', program], start_new_session=True)
    if not runtime.wait(_is_open, START_SEC):
        raise LabTimeout(
            f'Waited {START_SEC:.0f} s for the nodes of the stadium, but they did not come.',
            todo='Run the cell again. If that does not help, lab.doctor() looks for the reason.',
        )


def close_stadium() -> None:
    """End the stadium if it is open."""
    global _process
    if _process is not None:
        _process.terminate()
        _process.wait()
        _process = None


def wrong_gates() -> list[str]:
    """Return the names of the gates whose type is not that of the others, read off the graph."""
    gates = _types(VISITORS)
    return [name for name in GATES if gates.get(name, RIGHT_TYPE) != RIGHT_TYPE]


def _is_open() -> bool:
    """Say whether every node of the stadium is seen, and each with its publisher."""
    from labkit.background.runtime import runtime

    publishing = {*_types(VISITORS), *_types(GOALS)}
    return set(NODES) <= publishing and set(NODES) <= runtime.foreign_nodes()


def _types(topic: str) -> dict[str, str]:
    """Return the type of each node that publishes on a topic, by the node's full name."""
    from labkit.background.runtime import runtime

    assert runtime.helper is not None
    infos = runtime.helper.get_publishers_info_by_topic(topic)
    return {f'/{info.node_name}': info.topic_type for info in infos}


def main() -> None:
    """Publish until the program that has started this one ends."""
    import rclpy
    from rclpy.context import Context
    from rclpy.node import Node
    from rclpy.publisher import Publisher
    from rclpy.utilities import try_shutdown
    from std_msgs.msg import Int16, Int32

    parent = os.getppid()
    # A context has a DDS participant of its own, and each can have its own type for a topic.
    right, wrong = Context(), Context()
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
    while right.ok() and wrong.ok() and os.getppid() == parent:
        for publisher, msg_type in publishers:
            publisher.publish(msg_type(data=number // 10 % 1000))
        number += 1
        time.sleep(PERIOD_SEC)
    for context in (right, wrong):
        try_shutdown(context=context)
