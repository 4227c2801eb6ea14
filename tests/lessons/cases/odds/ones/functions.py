import rclpy
from std_msgs.msg import Int16

import labkit as lab

node = rclpy.create_node('unity')
publisher = node.create_publisher(Int16, '/ones', 1)
message = Int16(data=1)
node.create_timer(1 / 10, lambda: publisher.publish(message))
lab.spin(node)
