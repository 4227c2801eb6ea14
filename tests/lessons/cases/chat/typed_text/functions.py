import rclpy
from std_msgs.msg import String

import labkit as lab

node = lab.spin(rclpy.create_node('typist'))
publisher = node.create_publisher(String, '/hall', 1)


def ask():
    words = input()
    if words and not words.isspace():
        publisher.publish(String(data='Ada: ' + words.strip()))
