import math

from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Empty

import labkit as lab


class Guard(Node):
    def __init__(self):
        super().__init__('guard')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(LaserScan, 'scan', self.on_scan, qos_profile_sensor_data)
        self.create_subscription(Empty, 'go_wall', self.on_go, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.ahead = math.inf
        self.driving = False

    def on_scan(self, msg):
        # Others are no distances: inf, nan and 0.0 where a beam met nothing.
        beams = msg.ranges[:10] + msg.ranges[-10:]
        ahead = [way for way in beams if msg.range_min <= way <= msg.range_max]
        self.ahead = min(ahead, default=math.inf)

    def on_go(self, msg):
        self.driving = True

    def on_timer(self):
        if not self.driving:
            return
        msg = Twist()
        if self.ahead > 0.5:
            msg.linear.x = 0.2
        else:
            self.driving = False
        self.publisher.publish(msg)


guard = lab.spin(Guard())
