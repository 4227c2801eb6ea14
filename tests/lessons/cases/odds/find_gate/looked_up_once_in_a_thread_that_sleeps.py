import threading
import time

import rclpy
from std_msgs.msg import String

node = rclpy.create_node('referee_assistant')
publisher = node.create_publisher(String, '/wrong_gate', 1)
for info in node.get_publishers_info_by_topic('/visitors'):
    if 'Int16' not in info.topic_type:
        name = info.node_name


def work(publisher, name):
    while rclpy.ok():
        publisher.publish(String(data=name))
        time.sleep(0.7)


threading.Thread(target=work, args=[publisher, name], daemon=True).start()
