from geometry_msgs.msg import Twist
from rclpy.node import Node

import labkit as lab

node = lab.spin(Node('half_speed'))
publisher = node.create_publisher(Twist, 'slow/cmd_vel', 50)
with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as recording:
    commands = list(lab.bag('bags/commands').messages('/cmd_vel'))
    for found in reversed(commands):
        half = found.message
        half.linear.x /= 2
        half.angular.z /= 2
        publisher.publish(half)
    recording.wait_for(30)
