import math

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import JointState
from tf2_ros import TransformBroadcaster

import labkit as lab

RADIUS, SEPARATION = 0.033, 0.160


class WheelDriver(Node):
    def __init__(self):
        super().__init__('wheel_driver')
        self.publisher = self.create_publisher(Odometry, 'odom', 10)
        self.broadcaster = TransformBroadcaster(self)
        self.create_subscription(JointState, 'joint_states', self.on_joints, 10)
        self.at_x = self.at_y = self.heading = 0.0
        self.last = None

    def on_joints(self, msg):
        angles = dict(zip(msg.name, msg.position, strict=True))
        left, right = angles['wheel_left_joint'], angles['wheel_right_joint']
        if self.last is not None:
            self.roll(RADIUS * (left - self.last[0]), RADIUS * (right - self.last[1]))
        self.last = left, right
        self.tell(msg.header.stamp)

    def roll(self, left, right):
        way, turn = (left + right) / 2, (right - left) / SEPARATION
        self.at_x += way * math.cos(self.heading + turn / 2)
        self.at_y += way * math.sin(self.heading + turn / 2)
        self.heading += turn

    def tell(self, stamp):
        odom = Odometry(child_frame_id='base_footprint')
        odom.header.frame_id = 'odom'
        odom.header.stamp = stamp
        odom.pose.pose.position.x = self.at_x
        odom.pose.pose.position.y = self.at_y
        odom.pose.pose.orientation.z = math.sin(self.heading / 2)
        odom.pose.pose.orientation.w = math.cos(self.heading / 2)
        self.publisher.publish(odom)
        transform = TransformStamped(header=odom.header)
        transform.child_frame_id = odom.child_frame_id
        transform.transform.translation.x = odom.pose.pose.position.x
        transform.transform.translation.y = odom.pose.pose.position.y
        transform.transform.rotation = odom.pose.pose.orientation
        self.broadcaster.sendTransform(transform)


wheel_driver = lab.spin(WheelDriver())
