import math

from geometry_msgs.msg import Twist
from rclpy.node import Node
from sensor_msgs.msg import Imu
from std_msgs.msg import Empty

import labkit as lab


class Skater(Node):
    def __init__(self):
        super().__init__('skater')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Imu, 'imu', self.on_imu, 10)
        self.create_subscription(Empty, 'go_straight', self.on_go, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.yaw = 0.0
        self.steps = -1

    def on_imu(self, msg):
        q = msg.orientation
        self.yaw = 2 * math.atan2(q.z, q.w)

    def on_go(self, msg):
        self.wanted = self.yaw
        self.steps = 100

    def on_timer(self):
        if self.steps < 0:
            return
        error = self.wanted - self.yaw
        error = math.atan2(math.sin(error), math.cos(error))
        msg = Twist()
        if self.steps > 0:
            msg.linear.x = 0.2
            msg.angular.z = 3 * error
        self.steps -= 1
        self.publisher.publish(msg)


skater = lab.spin(Skater())
