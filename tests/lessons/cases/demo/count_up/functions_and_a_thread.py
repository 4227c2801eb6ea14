import threading
import time

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('odd_publisher')
publisher = node.create_publisher(Int16, '/demo_odds', 10)


def work():
    for value in range(1, 3001, 2):
        if not rclpy.ok():
            break
        publisher.publish(Int16(data=value))
        time.sleep(0.1)


threading.Thread(target=work, daemon=True).start()
