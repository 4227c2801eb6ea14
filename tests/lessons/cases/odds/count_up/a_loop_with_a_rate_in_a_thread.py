import threading
import time

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('loop')
publisher = node.create_publisher(Int16, 'odds', 1)


def work(publisher):
    for number in range(1, 2001, 2):
        if not rclpy.ok():
            break
        publisher.publish(Int16(data=number))
        time.sleep(1 / 5)


threading.Thread(target=work, args=[publisher], daemon=True).start()
