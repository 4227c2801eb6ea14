import rclpy
from std_msgs.msg import String

import labkit as lab

node = rclpy.create_node('metronome')
publisher = node.create_publisher(String, '/chatter', 1)


def tick():
    publisher.publish(String(data='tick'))


timer = node.create_timer(2, tick)
lab.spin(node)
