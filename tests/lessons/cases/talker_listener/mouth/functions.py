import rclpy
from std_msgs.msg import String

import labkit as lab

node = rclpy.create_node('mouth')
speech = node.create_publisher(String, '/speech', 5)


def say(message):
    loud = String()
    loud.data = message.data.upper()
    speech.publish(loud)


node.create_subscription(String, '/thought', say, 5)
lab.spin(node)
