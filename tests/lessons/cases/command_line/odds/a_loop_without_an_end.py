import rclpy
from std_msgs.msg import Int16

import labkit as lab

node = lab.spin(rclpy.create_node('odd_loop'))
publisher = node.create_publisher(Int16, 'odds', 10)
numbers = [1, 3, 5]


def on_timer():
    publisher.publish(Int16(data=numbers[0]))
    numbers.append(numbers.pop(0))


timer = node.create_timer(0.1, on_timer)
