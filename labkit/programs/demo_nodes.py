"""Stand-ins for the talker and the listener of ROS 2's package `demo_nodes_py`.

They do what the real ones do, for machines where that package is not installed:
`python3 -m labkit.programs.demo_nodes talker`.
"""

from __future__ import annotations

import sys

import rclpy
from rclpy.node import Node
from std_msgs.msg import String

from labkit.programs.program import spin_until_interrupted

__all__ = ['Listener', 'Talker']


class Talker(Node):
    """Publishes a greeting with a running number, once a second."""

    def __init__(self) -> None:
        super().__init__('talker')
        self._count = 0
        self._publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(1.0, self._on_timer)

    def _on_timer(self) -> None:
        message = String(data=f'Hello World: {self._count}')
        self._count += 1
        self.get_logger().info(f'Publishing: "{message.data}"')  # type: ignore[no-untyped-call]
        self._publisher.publish(message)


class Listener(Node):
    """Logs what it hears."""

    def __init__(self) -> None:
        super().__init__('listener')
        self.create_subscription(String, 'chatter', self._on_message, 10)

    def _on_message(self, message: String) -> None:
        self.get_logger().info(f'I heard: [{message.data}]')  # type: ignore[no-untyped-call]


NODES = {'listener': Listener, 'talker': Talker}


def main(words: list[str]) -> None:
    """Run a node until it is interrupted.

    Args:
        words: Its name, and arguments for ROS.
    """
    rclpy.init(args=words)
    spin_until_interrupted(NODES[words[0]]())


if __name__ == '__main__':
    main(sys.argv[1:])
