import math

from geometry_msgs.msg import Pose2D, Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node

import labkit as lab


class GoTo(Node):
    def __init__(self):
        super().__init__('go_to')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Odometry, 'odom', self.on_odometry, 10)
        self.create_subscription(Pose2D, 'goal', self.on_goal, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.x = self.y = self.yaw = 0.0
        self.goal = None

    def on_odometry(self, msg):
        self.x = msg.pose.pose.position.x
        self.y = msg.pose.pose.position.y
        q = msg.pose.pose.orientation
        self.yaw = 2 * math.atan2(q.z, q.w)

    def on_goal(self, msg):
        self.goal = msg

    def on_timer(self):
        if self.goal is None:
            return
        dx, dy = self.goal.x - self.x, self.goal.y - self.y
        error = math.atan2(dy, dx) - self.yaw
        error = math.atan2(math.sin(error), math.cos(error))
        msg = Twist()
        if math.hypot(dx, dy) < 0.05:
            self.goal = None
        else:
            msg.angular.z = 1.5 * error
            if abs(error) < 0.5:
                msg.linear.x = 0.2
        self.publisher.publish(msg)


go_to = lab.spin(GoTo())
