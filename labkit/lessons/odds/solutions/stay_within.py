from rclpy.node import Node
from std_msgs.msg import Int16

import labkit as lab


class LateOdds(Node):
    def __init__(self, first=1):
        super().__init__('late_odds')
        self.publisher = self.create_publisher(Int16, 'late_odds', 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.number = first

    def on_timer(self):
        self.publisher.publish(Int16(data=self.number))
        self.number += 2
        if self.number > 32767:
            self.number = 1


late_odds = lab.spin(LateOdds(first=32751))
