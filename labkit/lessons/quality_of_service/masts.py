"""A chain with a fault in it: masts carry a water level to a town, and one of them hears nothing.

`open_masts()` starts it as a process of its own. Which mast it is, and for which policy, is drawn
by lot, so the answer is in the graph and nowhere else.
"""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from labkit.lessons._companion import start_companion

if TYPE_CHECKING:
    from labkit.programs.child_processes import Process

__all__ = ['INT16', 'NODES', 'TOPICS', 'masts_are_open', 'open_masts']

INT16 = 'std_msgs/msg/Int16'
# Each node publishes on the topic of the same place, and hears the one before it.
NODES = ('/gauge', '/mast_a', '/mast_b', '/mast_c', '/town')
TOPICS = ('/level', '/level_a', '/level_b', '/level_c', '/display')
DEAF = (1, 2, 3)
# From one number to the next, on average, s.
PERIOD_SEC = 0.1
# How much higher the next level is: so no number is another one with 1 more or less.
STEPS = (2, 3, 4)
HIGHEST = 30_000

_process: Process | None = None


def open_masts() -> None:
    """Start the masts as a process, and wait until all of it is in the graph.

    Those that are open already are closed first. `lab.processes()` lists and stops them.

    Raises:
        LabTimeout: Their nodes did not come.
    """
    global _process
    _process = start_companion('masts', __name__, _process)
    print(f'The chain is there: {", ".join(NODES)}, in a process of its own.')


def masts_are_open() -> bool:
    """Tell whether the process runs."""
    return _process is not None and _process.running


def main() -> None:
    """Measure and pass on until it is interrupted."""
    import rclpy
    from rclpy.node import Node
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
    from std_msgs.msg import Int16

    from labkit.programs.program import spin_until_interrupted

    rclpy.init()
    # A check asks the gauge whether this process knows that it listens.
    nodes = [Node(name.lstrip('/'), start_parameter_services=name == NODES[0]) for name in NODES]
    usual = QoSProfile(depth=10)  # type: ignore[no-untyped-call]
    offered = QoSProfile(  # type: ignore[no-untyped-call]
        depth=10, reliability=ReliabilityPolicy.BEST_EFFORT
    )
    too_much = random.choice(
        [
            usual,
            QoSProfile(  # type: ignore[no-untyped-call]
                depth=10,
                reliability=ReliabilityPolicy.BEST_EFFORT,
                durability=DurabilityPolicy.TRANSIENT_LOCAL,
            ),
        ]
    )
    deaf, publishers = random.choice(DEAF), []
    for place, (node, topic) in enumerate(zip(nodes, TOPICS, strict=True)):
        publishers.append(
            node.create_publisher(Int16, topic, offered if place == deaf - 1 else usual)
        )
        if place:
            asked = too_much if place == deaf else usual
            node.create_subscription(Int16, TOPICS[place - 1], publishers[place].publish, asked)
    level = random.randint(100, 900)

    def measure() -> None:
        nonlocal level
        if random.random() < 0.5:
            return
        level = level % HIGHEST + random.choice(STEPS)
        publishers[0].publish(Int16(data=level))

    # Not as even as a timer: who repeats the newest one now and then leaves some out.
    nodes[0].create_timer(PERIOD_SEC / 2, measure)
    spin_until_interrupted(*nodes)
