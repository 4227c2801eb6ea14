"""A node that counts on a topic: 1, 2, 3, ..."""

from __future__ import annotations

import signal
import sys
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import Int16


class Counter(Node):
    """Publishes the next number often."""

    def __init__(self, name: str = 'counter', topic: str = 'odds') -> None:
        super().__init__(name)
        self.publisher = self.create_publisher(Int16, topic, 10)
        self.number = 0
        self.create_timer(0.02, self.on_timer)

    def on_timer(self) -> None:
        self.number += 1
        self.publisher.publish(Int16(data=self.number))


def main() -> None:
    """Run it under a name; with `late`, publish only when a check looks at it.

    At SIGUSR1 it has other things to do for 10 s. It is not stopped: Fast DDS takes the shared
    memory of a stopped process for dead, and each process that starts then prints an error.
    """
    name, *late = sys.argv[1:]
    signal.signal(signal.SIGUSR1, lambda *_: time.sleep(10.0))
    rclpy.init()
    if late:
        node = Node(name)
        while f'_check_{name}' not in node.get_node_names():
            time.sleep(0.01)
        time.sleep(3.0)  # a busy machine takes as long
        publisher = node.create_publisher(Int16, 'odds', 10)
        node.create_timer(0.02, lambda: publisher.publish(Int16(data=1)))
        rclpy.spin(node)
    rclpy.spin(Counter(name))


if __name__ == '__main__':
    main()
