import math

from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer, StaticTransformBroadcaster, TransformListener

import labkit as lab

SHEET = {
    'arm_foot': ('base_link', 0.05, 0.0, 0.14, 90.0),
    'arm_upper': ('arm_foot', 0.0, 0.03, 0.06, -35.0),
    'arm_lower': ('arm_upper', 0.11, 0.02, 0.0, 50.0),
    'arm_hand': ('arm_lower', 0.09, 0.01, 0.0, -20.0),
    'arm_finger': ('arm_hand', 0.04, 0.015, 0.0, 15.0),
}


class Mender(Node):
    def __init__(self):
        super().__init__('mender')
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.broadcaster = StaticTransformBroadcaster(self)
        self.timer = self.create_timer(0.2, self.on_timer)

    def on_timer(self):
        for frame, row in SHEET.items():
            if not self.buffer.can_transform(row[0], frame, Time()):
                return
        self.timer.cancel()
        for frame, row in SHEET.items():
            wanted = transform_of(frame, *row)
            found = self.buffer.lookup_transform(row[0], frame, Time())
            if differ(wanted.transform, found.transform):
                self.get_logger().info(f'{frame} is wrong')
                self.broadcaster.sendTransform(wanted)


def transform_of(frame, parent, x, y, z, yaw):
    found = TransformStamped(child_frame_id=frame)
    found.header.frame_id = parent
    shift, turn = found.transform.translation, found.transform.rotation
    shift.x, shift.y, shift.z = x, y, z
    turn.z = math.sin(math.radians(yaw) / 2)
    turn.w = math.cos(math.radians(yaw) / 2)
    return found


def differ(one, other):
    a, b = one.translation, other.translation
    p, q = one.rotation, other.rotation
    away = math.dist((a.x, a.y, a.z), (b.x, b.y, b.z))
    return away > 0.001 or abs(p.z * q.z + p.w * q.w) < 0.9999


mender = lab.spin(Mender())
