import threading
import time

from rclpy.node import Node
from std_msgs.msg import String

node = Node('metronome')
publisher = node.create_publisher(String, 'chatter', 10)


def work(publisher):
    while True:
        try:
            publisher.publish(String(data='tick'))
        except Exception:
            return
        time.sleep(2)


threading.Thread(target=work, args=(publisher,), daemon=True).start()
