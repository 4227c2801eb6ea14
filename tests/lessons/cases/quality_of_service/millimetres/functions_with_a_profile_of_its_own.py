import rclpy
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int16

import labkit as lab

node = rclpy.create_node('converter')
publisher = node.create_publisher(Int16, '/range_mm', 10)
profile = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
node.create_subscription(
    Int16, '/range', lambda msg: publisher.publish(Int16(data=msg.data * 10)), profile
)
lab.spin(node)
