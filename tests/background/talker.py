"""Cells with a talker and a listener, for notebooks that find other processes."""

LOCALHOST = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}

TALKER = """
import labkit as lab
from labkit.background.runtime import runtime
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self, name='talker'):
        super().__init__(name)
        self.count = 0
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.02, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data=WORD))
        self.count += 1

class Listener(Node):
    def __init__(self, name='listener'):
        super().__init__(name)
        self.heard = set()
        self.create_subscription(String, 'chatter', lambda msg: self.heard.add(msg.data), 10)
"""
