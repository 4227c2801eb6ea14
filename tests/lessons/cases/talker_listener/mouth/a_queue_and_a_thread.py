import queue
import threading

import rclpy
from std_msgs.msg import String

import labkit as lab

node = rclpy.create_node('mouth')
speech = node.create_publisher(String, 'speech', 10)
thoughts = queue.Queue()
node.create_subscription(String, 'thought', thoughts.put, 10)


def speak():
    while True:
        text = thoughts.get().data.upper()
        try:
            speech.publish(String(data=text))
        except Exception:
            return


threading.Thread(target=speak, daemon=True).start()
lab.spin(node)
