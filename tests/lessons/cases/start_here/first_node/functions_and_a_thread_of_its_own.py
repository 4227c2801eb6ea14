import threading

import rclpy
from rclpy.executors import MultiThreadedExecutor

node = rclpy.create_node('hello_robot')
executor = MultiThreadedExecutor()
executor.add_node(node)
threading.Thread(target=executor.spin, daemon=True).start()
