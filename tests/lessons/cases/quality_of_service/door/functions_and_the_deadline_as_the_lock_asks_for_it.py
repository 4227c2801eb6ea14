import rclpy
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int16

import labkit as lab

node = rclpy.create_node('gate')
profile = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
profile.durability = DurabilityPolicy.TRANSIENT_LOCAL
profile.deadline = Duration(seconds=1)
publisher = node.create_publisher(Int16, '/door', profile)
node.create_timer(0.2, lambda: publisher.publish(Int16(data=1)))
lab.spin(node)
