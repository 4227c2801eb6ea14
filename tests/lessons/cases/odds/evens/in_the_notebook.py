from rclpy.node import Node
from std_msgs.msg import Int16

import labkit as lab


class Evens(Node):
    def __init__(self):
        super().__init__('evens')
        self.publisher = self.create_publisher(Int16, 'evens', 10)
        self.subscription = self.create_subscription(Int16, 'odds', self.on_odd, 10)

    def on_odd(self, msg):
        self.publisher.publish(Int16(data=msg.data + 1))


evens = lab.spin(Evens())
