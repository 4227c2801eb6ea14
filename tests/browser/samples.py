"""Cells that several tests put into their notebooks."""

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
        self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        message = String(data=f'Hello World: {self.count}')
        self.publisher.publish(message)
        self.get_logger().info(f'Publishing: "{message.data}"')
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
