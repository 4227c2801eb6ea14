from rclpy.node import Node
from std_msgs.msg import Int16

import labkit as lab


class Ones(Node):
    def __init__(self):
        super().__init__('ones')
        self.publisher = self.create_publisher(Int16, 'ones', 10)
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        msg = Int16()
        msg.data = 1
        self.publisher.publish(msg)


ones = lab.spin(Ones())
