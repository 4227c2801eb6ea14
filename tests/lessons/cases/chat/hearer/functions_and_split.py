import rclpy
from std_msgs.msg import String

import labkit as lab

node = rclpy.create_node('reporter')


def report(msg):
    parts = msg.data.split(': ', 1)
    if len(parts) == 1:
        parts.insert(0, 'somebody')
    node.get_logger().warning(' says '.join(parts))


node.create_subscription(String, '/hall', report, 1)
lab.spin(node)
