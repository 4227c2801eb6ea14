import rclpy
from std_msgs.msg import String

import labkit as lab


def make_ear(name):
    ear = rclpy.create_node(name)
    publisher = ear.create_publisher(String, '/sound', 1)
    ear.create_timer(1 / 5, lambda: publisher.publish(String(data=f'{name} hears rain')))
    lab.spin(ear)


make_ear('left_ear')
make_ear('right_ear')
