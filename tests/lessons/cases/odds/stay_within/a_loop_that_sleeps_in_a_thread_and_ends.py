import threading
import time

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('sleeper')
publisher = node.create_publisher(Int16, 'late_odds', 10)


def work(publisher):
    for number in range(32751, 32768, 2):
        publisher.publish(Int16(data=number))
        time.sleep(0.1)


threading.Thread(target=work, args=[publisher], daemon=True).start()
