from rclpy.action import ActionServer
from rclpy.node import Node
from test_msgs.action import Fibonacci

import labkit as lab


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


lab.spin(Squares())
