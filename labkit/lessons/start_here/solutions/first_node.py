from rclpy.node import Node

import labkit as lab

lab.spin(Node('hello_robot'))
