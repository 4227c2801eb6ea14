import threading

import rclpy
from std_msgs.msg import String

import labkit as lab

node = lab.spin(rclpy.create_node('lighthouse'))
publisher = node.create_publisher(String, '/beacon', 10)


def work(node, publisher):
    rate = node.create_rate(4)
    for _ in range(600):
        publisher.publish(String(data='I am here'))
        rate.sleep()


threading.Thread(target=work, args=(node, publisher), daemon=True).start()
