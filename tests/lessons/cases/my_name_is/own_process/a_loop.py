import time

import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('somebody')
publisher = node.create_publisher(String, '/incomplete', 1)
while rclpy.ok():
    publisher.publish(String(data='My name is '))
    time.sleep(0.5)
