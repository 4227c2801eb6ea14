import math

from geometry_msgs.msg import Pose2D, Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node

import labkit as lab


class Pusher(Node):
    def __init__(self):
        super().__init__('pusher')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Odometry, 'odom', self.on_odometry, 10)
        self.create_subscription(Pose2D, 'crate', self.on_crate, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.x = self.y = self.yaw = 0.0
        self.points = []

    def on_odometry(self, msg):
        self.x = msg.pose.pose.position.x
        self.y = msg.pose.pose.position.y
        q = msg.pose.pose.orientation
        self.yaw = 2 * math.atan2(q.z, q.w)

    def on_crate(self, msg):
        # x, y, and whether it drives there ahead (1) or back (-1).
        self.points = [
            (msg.x - 0.4, msg.y, 1),
            (1.24, msg.y, 1),
            (0.9, msg.y, -1),
            (1.36, msg.y - 0.45, 1),
            (1.36, 1.24, 1),
        ]

    def on_timer(self):
        if not self.points:
            return
        x, y, way = self.points[0]
        dx, dy = x - self.x, y - self.y
        error = math.atan2(way * dy, way * dx) - self.yaw
        error = math.atan2(math.sin(error), math.cos(error))
        msg = Twist()
        if math.hypot(dx, dy) < 0.03:
            self.points.pop(0)
        else:
            msg.angular.z = max(-1.5, min(1.5, 2 * error))
            if abs(error) < 0.1:
                msg.linear.x = way * 0.2
        self.publisher.publish(msg)


pusher = lab.spin(Pusher())
