import threading
import time

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('sleeper')
publisher = node.create_publisher(Int16, 'ones', 10)


def work(publisher):
    while rclpy.ok():
        publisher.publish(Int16(data=1))
        time.sleep(0.1)


threading.Thread(target=work, args=[publisher], daemon=True).start()
