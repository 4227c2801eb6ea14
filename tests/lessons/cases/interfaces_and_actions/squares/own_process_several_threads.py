import rclpy
from rclpy.action import ActionServer
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from test_msgs.action import Fibonacci


class Squares(Node):
    def __init__(self):
        super().__init__('squares')
        self.server = ActionServer(self, Fibonacci, 'squares', self.execute)

    def execute(self, goal_handle):
        numbers = []
        for i in range(goal_handle.request.order):
            numbers.append(i * i)
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        goal_handle.succeed()
        return Fibonacci.Result(sequence=numbers)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor()
    executor.add_node(Squares())
    executor.spin()


main()
