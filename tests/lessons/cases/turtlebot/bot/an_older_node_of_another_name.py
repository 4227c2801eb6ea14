from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Empty

import labkit as lab


class HomingBot(Node):
    def __init__(self):
        super().__init__('old_bot')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Odometry, 'odom', self.on_odometry, 10)
        self.create_subscription(Empty, 'go_home', self.on_go, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.x = 0.0
        self.steps = 0

    def on_odometry(self, msg):
        self.x = msg.pose.pose.position.x

    def on_go(self, msg):
        self.steps = 21

    def on_timer(self):
        if self.steps == 0:
            return
        self.steps -= 1
        msg = Twist()
        if self.steps > 0:
            msg.linear.x = -self.x
        self.publisher.publish(msg)


homing_bot = lab.spin(HomingBot())

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Empty


class HomingBot(Node):
    def __init__(self):
        super().__init__('homing_bot')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Odometry, 'odom', self.on_odometry, 10)
        self.create_subscription(Empty, 'go_home', self.on_go, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.x = 0.0
        self.steps = 0

    def on_odometry(self, msg):
        self.x = msg.pose.pose.position.x

    def on_go(self, msg):
        self.steps = 21

    def on_timer(self):
        if self.steps == 0:
            return
        self.steps -= 1
        msg = Twist()
        if self.steps > 0:
            msg.linear.x = -self.x
        self.publisher.publish(msg)


homing_bot = lab.spin(HomingBot())
