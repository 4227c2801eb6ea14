import rclpy
from std_msgs.msg import Int16

import labkit as lab

node = rclpy.create_node('successor')
publisher = node.create_publisher(Int16, '/evens', 10)
node.create_subscription(
    Int16, '/odds', lambda odd: publisher.publish(Int16(data=odd.data + 1)), 10
)
lab.spin(node)
