import threading

import rclpy
from rclpy.executors import MultiThreadedExecutor
from std_msgs.msg import Int16

node = rclpy.create_node('ones')
publisher = node.create_publisher(Int16, 'ones', 10)
node.create_timer(0.1, lambda: publisher.publish(Int16(data=1)))
executor = MultiThreadedExecutor()
executor.add_node(node)
threading.Thread(target=executor.spin, daemon=True).start()
