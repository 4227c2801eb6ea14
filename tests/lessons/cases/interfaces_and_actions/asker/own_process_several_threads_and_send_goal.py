import rclpy
from rclpy.action import ActionClient
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int16, Int32
from test_msgs.action import Fibonacci


class Asker(Node):
    def __init__(self):
        super().__init__('asker')
        self.client = ActionClient(
            self, Fibonacci, 'add_up', callback_group=MutuallyExclusiveCallbackGroup()
        )
        self.publisher = self.create_publisher(Int32, 'sum', 10)
        self.subscription = self.create_subscription(Int16, 'wish', self.on_wish, 10)

    def on_wish(self, msg):
        answer = self.client.send_goal(Fibonacci.Goal(order=msg.data))
        self.publisher.publish(Int32(data=answer.result.sequence[-1]))


def main():
    rclpy.init()
    executor = MultiThreadedExecutor()
    executor.add_node(Asker())
    executor.spin()


main()
