import rclpy
from std_msgs.msg import Int16

import labkit as lab

node = lab.spin(rclpy.create_node('ones'))
publisher = node.create_publisher(Int16, 'ones', 10)
publisher.publish(Int16(data=1))
