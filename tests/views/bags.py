"""Bags for tests of the picture of a bag: drives whose times are exact, and a foreign type."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from sensor_msgs.msg import Image, LaserScan

from labkit.bags.writer import BagWriter

START_NS = 1_700_000_000_000_000_000
ARM = 'my_robot_msgs/msg/Arm'
ARM_DEFINITION = 'std_msgs/Header header\nfloat32[] angles\nJoint first\nstring state\n' + (
    '=' * 80 + '\nMSG: my_robot_msgs/Joint\nfloat64 position\nstring name\n'
)


def make_drive(path: Path, *, storage: str = 'mcap', seconds: float = 10.0) -> Path:
    """Make a bag of a drive: /odom at 10 Hz, /scan at 2 Hz, /cmd_vel until half of the time."""
    writer = BagWriter(path, storage)
    numbers = {
        name: writer.add_topic(name, msg_type, qos='', definition='', encoding='')
        for name, msg_type in (
            ('/cmd_vel', 'geometry_msgs/msg/Twist'),
            ('/odom', 'nav_msgs/msg/Odometry'),
            ('/scan', 'sensor_msgs/msg/LaserScan'),
            ('/never', 'std_msgs/msg/String'),
        )
    }
    for step in range(round(10 * seconds) + 1):
        stamp = START_NS + step * 100_000_000
        messages: list[tuple[str, Any]] = [('/odom', odometry(0.02 * step, 0.0, 0.01 * step))]
        if step <= 5 * seconds and step % 5 == 0:
            command = Twist()
            command.linear.x = 0.2
            messages.append(('/cmd_vel', command))
        if step % 5 == 0:
            messages.append(('/scan', scan(2.0 - 0.01 * step)))
        writer.write(
            [(numbers[name], stamp, stamp, serialize_message(each)) for name, each in messages]
        )
    writer.close()
    return path


def make_camera(path: Path, *encodings: str) -> Path:
    """Make a bag of /camera, with a picture of 2 x 2 pixels each second."""
    writer = BagWriter(path)
    number = writer.add_topic(
        '/camera', 'sensor_msgs/msg/Image', qos='', definition='', encoding=''
    )
    for second, encoding in enumerate(encodings):
        stamp = START_NS + second * 1_000_000_000
        image = Image(height=2, width=2, encoding=encoding, step=6, data=[200] * 12)
        writer.write([(number, stamp, stamp, serialize_message(image))])
    writer.close()
    return path


def make_foreign(
    path: Path, *, topic: str = '/arm', count: int = 5, damaged: bool = False
) -> Path:
    """Make a bag with a type that is not installed; damaged, the last text is too long."""
    store = get_typestore(Stores.ROS2_JAZZY)
    types = get_types_from_msg(ARM_DEFINITION, ARM)
    store.register({name: what for name, what in types.items() if name not in store.fielddefs})
    writer = BagWriter(path)
    number = writer.add_topic(topic, ARM, qos='', definition=ARM_DEFINITION, encoding='ros2msg')
    stamp_type = store.types['builtin_interfaces/msg/Time']
    header_type, joint = store.types['std_msgs/msg/Header'], store.types['my_robot_msgs/msg/Joint']
    for step in range(count):
        message = store.types[ARM](
            header_type(stamp_type(step, 0), '<b>frame</b>'),
            np.array([0.5 * step, 1.0], dtype=np.float32),
            joint(2.0 * step, 'elbow'),
            '<img src=x onerror=alert(1)>',
        )
        data = bytes(store.serialize_cdr(message, ARM))
        if damaged and step == count - 1:
            data = data.replace(b'\6\0\0\0elbow', b'\xff\xff\xff\xffelbow')
        writer.write([(number, START_NS + step * 10**9, START_NS + step * 10**9, data)])
    writer.close()
    return path


def make_empty(path: Path) -> Path:
    """Make a bag with a topic, and no message."""
    writer = BagWriter(path)
    writer.add_topic('/odom', 'nav_msgs/msg/Odometry', qos='', definition='', encoding='')
    writer.close()
    return path


def odometry(x: float, y: float, yaw: float) -> Odometry:
    """Return where a robot is."""
    message = Odometry()
    message.pose.pose.position.x, message.pose.pose.position.y = x, y
    turn = message.pose.pose.orientation
    turn.z, turn.w = math.sin(yaw / 2), math.cos(yaw / 2)
    message.twist.twist.linear.x = 0.2
    return message


def scan(ahead: float) -> LaserScan:
    """Return what a scanner sees that has a wall ahead, and nothing elsewhere."""
    message = LaserScan(angle_increment=math.tau / 8, range_min=0.1, range_max=3.5)
    message.ranges = [ahead, *[math.inf] * 7]
    return message
