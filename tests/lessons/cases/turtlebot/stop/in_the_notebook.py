from geometry_msgs.msg import Twist
from rclpy.node import Node

import labkit as lab


class Cruiser(Node):
    def __init__(self):
        super().__init__('cruiser')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        msg = Twist()
        msg.linear.x = 0.1
        self.publisher.publish(msg)

    def destroy_node(self):
        self.publisher.publish(Twist())
        super().destroy_node()


cruiser = lab.spin(Cruiser())
