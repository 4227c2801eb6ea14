import rclpy
from std_msgs.msg import String

import labkit as lab

node = rclpy.create_node('mouthpiece')
publisher = node.create_publisher(String, '/hall', 10)


def say(msg):
    words = msg.data.strip()
    if words != '':
        publisher.publish(String(data='Ada: ' + words))


node.create_subscription(String, '/typed', say, 10)
lab.spin(node)
