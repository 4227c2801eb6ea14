import rclpy
from std_msgs.msg import String

import labkit as lab

node = rclpy.create_node('secretary')


def note(message):
    node.get_logger().warning('noted: ' + message.data)


node.create_subscription(String, '/chatter', note, 1)
lab.spin(node)
