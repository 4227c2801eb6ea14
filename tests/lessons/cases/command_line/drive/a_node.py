import rclpy
from geometry_msgs.msg import Twist

import labkit as lab

node = lab.spin(rclpy.create_node('driver'))
publisher = node.create_publisher(Twist, '/cmd_vel', 10)
twist = Twist()
twist.linear.x, twist.angular.z = 0.2, 0.5
rate = node.create_rate(10)
for _ in range(5):
    publisher.publish(twist)
    rate.sleep()
