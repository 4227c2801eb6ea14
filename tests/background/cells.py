"""Cells that several tests run: the imports, a talker, a listener."""

from __future__ import annotations

SETUP = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String
"""

TALKER = """
class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.count = 0
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data=f'Hello World: {self.count}'))
        self.count += 1

talker = lab.spin(Talker())
"""

LISTENER = """
class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        self.heard = []
        self.create_subscription(String, 'chatter', self.on_message, 10)

    def on_message(self, message):
        self.heard.append(message.data)

listener = lab.spin(Listener())
"""
