import threading
import time

from rclpy.node import Node
from std_msgs.msg import String

node = Node('lighthouse')
publisher = node.create_publisher(String, 'beacon', 10)


def work(publisher):
    while True:
        time.sleep(0.25)
        try:
            publisher.publish(String(data='I am here'))
        except Exception:
            return


threading.Thread(target=work, args=(publisher,), daemon=True).start()
