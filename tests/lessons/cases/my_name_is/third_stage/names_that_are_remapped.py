from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab

names = ['--ros-args', '-r', 'heard:=/complete', '-r', 'said:=/greeting']
node = Node('polite', namespace='house', cli_args=names)
publisher = node.create_publisher(String, 'said', 10)


def bow(text):
    publisher.publish(String(data=''.join([text.data, '. Nice to meet you.'])))


node.create_subscription(String, 'heard', bow, 10)
lab.spin(node)
