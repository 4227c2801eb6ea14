import math

from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from tf2_ros import StaticTransformBroadcaster

import labkit as lab


class SonarDriver(Node):
    def __init__(self):
        super().__init__('sonar_driver')
        self.broadcaster = StaticTransformBroadcaster(self)
        mount = TransformStamped()
        mount.header.stamp = self.get_clock().now().to_msg()
        mount.header.frame_id = 'base_link'
        mount.child_frame_id = 'sonar_link'
        mount.transform.translation.x = 0.06
        mount.transform.translation.y = 0.04
        mount.transform.translation.z = 0.12
        yaw = math.radians(30)
        mount.transform.rotation.z = math.sin(yaw / 2)
        mount.transform.rotation.w = math.cos(yaw / 2)
        self.broadcaster.sendTransform(mount)


sonar_driver = lab.spin(SonarDriver())
