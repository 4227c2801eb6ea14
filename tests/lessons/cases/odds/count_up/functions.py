import itertools

import rclpy
from std_msgs.msg import Int16

import labkit as lab

node = rclpy.create_node('counter')
publisher = node.create_publisher(Int16, '/odds', 10)
numbers = itertools.cycle(range(1, 32767, 2))
node.create_timer(0.2, lambda: publisher.publish(Int16(data=next(numbers))))
lab.spin(node)
