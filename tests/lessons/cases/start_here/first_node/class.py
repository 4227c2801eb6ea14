from rclpy.node import Node

import labkit as lab


class HelloRobot(Node):
    def __init__(self):
        super().__init__('hello_robot')


robot = lab.spin(HelloRobot())
