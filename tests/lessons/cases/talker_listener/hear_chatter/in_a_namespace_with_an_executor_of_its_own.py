import threading

from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

ear = Node('ear', namespace='head')
ear.create_subscription(
    String, '/chatter', lambda msg: ear.get_logger().info(f'{msg.data} was said'), 10
)
executor = MultiThreadedExecutor()
executor.add_node(ear)
threading.Thread(target=executor.spin, daemon=True).start()
