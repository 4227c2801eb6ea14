import rclpy
from std_msgs.msg import Int16

import labkit as lab

node = rclpy.create_node('one')
publisher = node.create_publisher(Int16, 'odds', 10)
calls = 0


def on_timer():
    global calls
    if calls % 4 == 0:
        publisher.publish(Int16(data=calls // 2 + 1))
    calls += 1


node.create_timer(0.05, on_timer)
lab.spin(node)
