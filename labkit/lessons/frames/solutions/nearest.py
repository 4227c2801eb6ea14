import math

from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rclpy.time import Time
from sensor_msgs.msg import LaserScan
from tf2_geometry_msgs import do_transform_point
from tf2_ros import Buffer, TransformException, TransformListener

import labkit as lab


class Nearest(Node):
    def __init__(self):
        super().__init__('nearest')
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(PointStamped, 'nearest', 10)
        self.create_subscription(LaserScan, 'scan', self.on_scan, qos_profile_sensor_data)

    def on_scan(self, scan):
        beams = enumerate(scan.ranges)
        valid = [(d, i) for i, d in beams if scan.range_min <= d <= scan.range_max]
        if not valid:
            return
        distance, i = min(valid)
        angle = scan.angle_min + i * scan.angle_increment
        point = PointStamped(header=scan.header)
        point.point.x = distance * math.cos(angle)
        point.point.y = distance * math.sin(angle)
        frame, stamp = scan.header.frame_id, Time.from_msg(scan.header.stamp)
        try:
            transform = self.buffer.lookup_transform('odom', frame, stamp)
        except TransformException as error:
            self.get_logger().info(str(error), throttle_duration_sec=5.0)
            return
        found = do_transform_point(point, transform)
        self.publisher.publish(found)


nearest = lab.spin(Nearest())
