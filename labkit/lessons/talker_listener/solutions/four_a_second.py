from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab


class Beacon(Node):
    period = 0.25  # in seconds

    def __init__(self):
        super().__init__('beacon')
        self.publisher = self.create_publisher(String, 'beacon', 10)
        self.timer = self.create_timer(self.period, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='I am here'))


if Beacon.period is not ...:
    beacon = lab.spin(Beacon())
