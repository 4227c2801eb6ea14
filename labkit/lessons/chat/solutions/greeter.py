from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Greeter(Node):
    def __init__(self):
        super().__init__('greeter')
        self.subscription = self.create_subscription(String, 'lobby', self.on_message, 10)

    def on_message(self, msg):
        if 'Hello' in msg.data:
            publisher = self.create_publisher(String, 'lobby', 10)
            publisher.publish(String(data='Ada: Salut'))
            publisher.wait_for_all_acked(Duration(seconds=1))
            self.destroy_publisher(publisher)


greeter = lab.spin(Greeter())
