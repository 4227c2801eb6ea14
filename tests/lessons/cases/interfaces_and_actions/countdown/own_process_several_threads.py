import time

import rclpy
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from test_msgs.action import Fibonacci


class Countdown(Node):
    def __init__(self):
        super().__init__('countdown')
        group = ReentrantCallbackGroup()
        self.server = ActionServer(
            self, Fibonacci, 'countdown', self.execute, callback_group=group
        )
        self.server.register_cancel_callback(self.on_cancel)

    def on_cancel(self, goal_handle):
        return CancelResponse.ACCEPT

    def execute(self, goal_handle):
        numbers = []
        for number in range(goal_handle.request.order, -1, -1):
            time.sleep(0.05)
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return Fibonacci.Result(sequence=numbers)
            numbers.append(number)
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        goal_handle.succeed()
        return Fibonacci.Result(sequence=numbers)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor()
    executor.add_node(Countdown())
    executor.spin()


main()
