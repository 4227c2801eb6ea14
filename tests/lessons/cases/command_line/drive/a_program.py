import time

import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.left = 5
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        if self.left and self.publisher.get_subscription_count():
            self.publisher.publish(Twist(linear=Vector3(x=0.2), angular=Vector3(z=0.5)))
            self.left -= 1


rclpy.init()
driver = Driver()
while driver.left:
    rclpy.spin_once(driver)
time.sleep(1)
