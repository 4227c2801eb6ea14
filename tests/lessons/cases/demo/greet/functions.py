import rclpy
from std_msgs.msg import String

import labkit as lab

node = rclpy.create_node('another_name')
pub = node.create_publisher(String, '/demo_complete', 1)


def answer(m):
    pub.publish(String(data=f'{m.data}Ada'))
    node.get_logger().warning('got ' + m.data)


node.create_subscription(String, '/demo_incomplete', answer, 1)
lab.spin(node)
