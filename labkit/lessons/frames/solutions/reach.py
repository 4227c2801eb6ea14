import math

from geometry_msgs.msg import PointStamped, Twist
from rclpy.node import Node
from rclpy.time import Time
from tf2_geometry_msgs import do_transform_point
from tf2_ros import Buffer, TransformListener

import labkit as lab


class Reach(Node):
    def __init__(self):
        super().__init__('reach')
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(PointStamped, 'target', self.on_target, 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.goal = None

    def on_target(self, msg):
        # Once: the frame of the robot moves, and a point that is fixed there moves with it.
        self.goal = self.seen_from('odom', msg)

    def on_timer(self):
        if self.goal is None:
            return
        point = self.seen_from('base_footprint', self.goal).point
        msg = Twist()
        if math.hypot(point.x, point.y) < 0.05:
            self.goal = None
        else:
            error = math.atan2(point.y, point.x)
            msg.angular.z = 1.5 * error
            if abs(error) < 0.5:
                msg.linear.x = 0.2
        self.publisher.publish(msg)

    def seen_from(self, frame, point):
        transform = self.buffer.lookup_transform(frame, point.header.frame_id, Time())
        return do_transform_point(point, transform)


reach = lab.spin(Reach())
