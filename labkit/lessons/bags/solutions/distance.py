import math

from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float64

import labkit as lab


class Distance(Node):
    def __init__(self):
        super().__init__('distance')
        self.publisher = self.create_publisher(Float64, 'distance', 10)
        self.subscription = self.create_subscription(Odometry, 'odom', self.on_odometry, 10)
        self.last = None
        self.total = 0.0

    def on_odometry(self, msg):
        position = msg.pose.pose.position
        place = (position.x, position.y)
        if self.last is not None:
            step = math.dist(self.last, place)
            if step < 0.5:
                self.total += step
        self.last = place
        self.publisher.publish(Float64(data=self.total))


distance = lab.spin(Distance())
