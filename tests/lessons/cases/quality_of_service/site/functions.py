import rclpy
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from std_msgs.msg import String

import labkit as lab

node = rclpy.create_node('builder')
profile = QoSProfile(depth=1)
profile.durability = QoSDurabilityPolicy.TRANSIENT_LOCAL
publisher = node.create_publisher(String, '/site', profile)
node.create_subscription(String, '/move', publisher.publish, 10)
lab.spin(node)
