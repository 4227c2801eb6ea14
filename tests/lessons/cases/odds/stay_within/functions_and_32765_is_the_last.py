import itertools

import rclpy
from std_msgs.msg import Int16

import labkit as lab

node = rclpy.create_node('counter')
publisher = node.create_publisher(Int16, '/late_odds', 10)
numbers = itertools.chain(range(32751, 32767, 2), itertools.cycle(range(1, 32767, 2)))
node.create_timer(0.1, lambda: publisher.publish(Int16(data=next(numbers))))
lab.spin(node)
