from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

import labkit as lab


class Site(Node):
    def __init__(self):
        super().__init__('site')
        profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, 'site', profile)
        self.subscription = self.create_subscription(String, 'move', self.on_move, 10)

    def on_move(self, msg):
        self.publisher.publish(msg)


site = lab.spin(Site())
