import threading

from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool


class Porter(Node):
    def __init__(self):
        super().__init__('porter')
        group = MutuallyExclusiveCallbackGroup()
        self.client = self.create_client(SetBool, 'move_door', callback_group=group)
        self.publisher = self.create_publisher(String, 'news', 10)
        self.create_subscription(Bool, 'wish', self.on_wish, 10)

    def on_wish(self, msg):
        response = self.client.call(SetBool.Request(data=msg.data))
        self.publisher.publish(String(data=response.message))


executor = MultiThreadedExecutor()
executor.add_node(Porter())
threading.Thread(target=executor.spin, daemon=True).start()
