from rclpy.action import ActionClient
from rclpy.node import Node
from std_msgs.msg import Int16, Int32
from test_msgs.action import Fibonacci

import labkit as lab


class Asker(Node):
    def __init__(self):
        super().__init__('asker')
        self.client = ActionClient(self, Fibonacci, 'add_up')
        self.publisher = self.create_publisher(Int32, 'sum', 10)
        self.subscription = self.create_subscription(Int16, 'wish', self.on_wish, 10)

    def on_wish(self, msg):
        future = self.client.send_goal_async(Fibonacci.Goal(order=msg.data))
        future.add_done_callback(self.on_accepted)

    def on_accepted(self, future):
        future.result().get_result_async().add_done_callback(self.on_result)

    def on_result(self, future):
        self.publisher.publish(Int32(data=future.result().result.sequence[-1]))


lab.spin(Asker())
