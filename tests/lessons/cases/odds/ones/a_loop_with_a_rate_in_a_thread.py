import threading

import rclpy
from std_msgs.msg import Int16

import labkit as lab

node = lab.spin(rclpy.create_node('loop'))
publisher = node.create_publisher(Int16, 'ones', 10)


def work(publisher):
    rate = node.create_rate(10)
    for _ in range(600):
        publisher.publish(Int16(data=1))
        rate.sleep()


threading.Thread(target=work, args=[publisher], daemon=True).start()
