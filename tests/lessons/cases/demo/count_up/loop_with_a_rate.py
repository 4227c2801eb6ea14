import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import Int16


def main():
    rclpy.init()
    node = Node('odd_publisher')
    publisher = node.create_publisher(Int16, 'demo_odds', 1)
    rate = node.create_rate(10)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    value = -1
    while rclpy.ok():
        value = value + 2
        publisher.publish(Int16(data=value))
        rate.sleep()


threading.Thread(target=main, daemon=True).start()
