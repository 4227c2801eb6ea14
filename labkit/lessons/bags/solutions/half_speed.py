from geometry_msgs.msg import Twist
from rclpy.node import Node

import labkit as lab


class HalfSpeed(Node):
    def __init__(self):
        super().__init__('half_speed')
        self.publisher = self.create_publisher(Twist, 'slow/cmd_vel', 50)
        self.subscription = self.create_subscription(Twist, 'cmd_vel', self.on_command, 50)

    def on_command(self, msg):
        half = Twist()
        half.linear.x = msg.linear.x / 2
        half.angular.z = msg.angular.z / 2
        self.publisher.publish(half)


half_speed = lab.spin(HalfSpeed())

with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as recording:
    lab.play('bags/commands', '/cmd_vel', wait=True)
    recording.wait_for(30)
