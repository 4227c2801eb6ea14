from rclpy.node import Node
from std_msgs.msg import Int16

import labkit as lab


class Odds(Node):
    def __init__(self):
        super().__init__('odd_source')
        self.publisher = self.create_publisher(Int16, 'odds', 10)
        self.timer = self.create_timer(0.2, self.on_timer)
        self.number = 1

    def on_timer(self):
        msg = Int16()
        msg.data = self.number
        self.publisher.publish(msg)
        self.number += 2


odds = lab.spin(Odds())
