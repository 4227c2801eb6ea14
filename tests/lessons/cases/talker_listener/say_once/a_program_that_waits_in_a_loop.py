import time

import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('door')
publisher = node.create_publisher(String, 'door', 10)
while publisher.get_subscription_count() == 0:
    time.sleep(0.05)
publisher.publish(String(data='The door is open'))
rclpy.spin(node)
