import threading

from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

node = Node('reader', namespace='sea', cli_args=['--ros-args', '-r', 'light:=/beacon'])
publisher = node.create_publisher(String, 'light', 10)
node.create_timer(0.25, lambda: publisher.publish(String(data='I am here')))
executor = MultiThreadedExecutor()
executor.add_node(node)
threading.Thread(target=executor.spin, daemon=True).start()
