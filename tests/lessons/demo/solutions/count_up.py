from rclpy.node import Node
from std_msgs.msg import Int16

import labkit as lab


class OddPublisher(Node):
    def __init__(self):
        super().__init__('odd_publisher')
        self.publisher = self.create_publisher(Int16, 'demo_odds', 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.number = 1

    def on_timer(self):
        msg = Int16()
        msg.data = self.number
        self.publisher.publish(msg)
        self.number += 2


lab.spin(OddPublisher())
