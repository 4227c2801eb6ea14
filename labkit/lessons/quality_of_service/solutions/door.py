from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Int16

import labkit as lab


class Door(Node):
    def __init__(self):
        super().__init__('door')
        profile = QoSProfile(
            depth=1,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
            deadline=Duration(seconds=0.5),
        )
        self.publisher = self.create_publisher(Int16, 'door', profile)
        self.timer = self.create_timer(0.2, self.on_timer)

    def on_timer(self):
        self.publisher.publish(Int16(data=1))


door = lab.spin(Door())
