import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Ear(Node):
    def __init__(self):
        super().__init__('ear')
        self.subscription = self.create_subscription(String, 'chatter', self.on_message, 10)

    def on_message(self, msg):
        self.get_logger().info(f'I heard: "{msg.data}"')


def main():
    rclpy.init()
    ear = Ear()
    time.sleep(60)
    ear.destroy_node()


main()
