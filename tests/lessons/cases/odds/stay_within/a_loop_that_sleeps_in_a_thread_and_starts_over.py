import threading
import time

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('sleeper')
publisher = node.create_publisher(Int16, 'late_odds', 10)


def work(publisher):
    number = 32751
    while rclpy.ok():
        publisher.publish(Int16(data=number))
        number = number + 2 if number < 32767 else 1
        time.sleep(0.1)


threading.Thread(target=work, args=[publisher], daemon=True).start()
