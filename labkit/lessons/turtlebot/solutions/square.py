from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Empty

import labkit as lab


class Square(Node):
    def __init__(self):
        super().__init__('square')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Empty, 'go_square', self.on_go, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.plan = []

    def on_go(self, msg):
        side = 20 * [(0.2, 0.0)] + 2 * [(0.0, 0.0)]
        turn = 10 * [(0.0, 1.5708)] + 5 * [(0.0, 0.0)]
        self.plan = 4 * (side + turn)

    def on_timer(self):
        if not self.plan:
            return
        v, w = self.plan.pop(0)
        msg = Twist()
        msg.linear.x, msg.angular.z = v, w
        self.publisher.publish(msg)


square = lab.spin(Square())
