from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Hearer(Node):
    def __init__(self):
        super().__init__('hearer')
        self.subscription = self.create_subscription(String, 'hall', self.on_message, 10)

    def on_message(self, msg):
        who, colon, text = msg.data.partition(': ')
        if not colon:
            who, text = 'somebody', msg.data
        self.get_logger().info(f'{who} says {text}')


hearer = lab.spin(Hearer())
