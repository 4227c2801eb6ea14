import time

import rclpy
from rclpy.node import Node


class HelloRobot(Node):
    def __init__(self):
        super().__init__('hello_robot')


def main():
    rclpy.init()
    robot = HelloRobot()
    time.sleep(60)
    robot.destroy_node()


main()
