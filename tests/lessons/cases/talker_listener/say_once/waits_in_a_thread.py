import threading
import time

from rclpy.node import Node
from std_msgs.msg import String

import labkit as lab

node = lab.spin(Node('door'))
publisher = node.create_publisher(String, 'door', 10)


def work(publisher):
    try:
        while publisher.get_subscription_count() == 0:
            time.sleep(0.1)
        publisher.publish(String(data='The door is open'))
    except Exception:
        return


threading.Thread(target=work, args=(publisher,), daemon=True).start()
