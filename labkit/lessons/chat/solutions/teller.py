from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Teller(Node):
    def __init__(self):
        super().__init__('teller')
        self.publisher = self.create_publisher(String, 'hall', 10)
        self.subscription = self.create_subscription(String, 'typed', self.on_typed, 10)

    def on_typed(self, msg):
        text = msg.data.strip()
        if text:
            self.publisher.publish(String(data=f'Ada: {text}'))


teller = lab.spin(Teller())
