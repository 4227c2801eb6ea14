import queue
import threading

from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab

ear = Node('ear')
heard = queue.Queue()
ear.create_subscription(String, 'chatter', heard.put, 10)


def write(ear, heard):
    while True:
        ear.get_logger().info(heard.get().data)


threading.Thread(target=write, args=(ear, heard), daemon=True).start()
lab.spin(ear)
