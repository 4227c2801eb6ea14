from rclpy.action import ActionServer, GoalResponse
from rclpy.node import Node
from test_msgs.action import Fibonacci

import labkit as lab


class Stairs(Node):
    def __init__(self):
        super().__init__('stairs')
        self.server = ActionServer(self, Fibonacci, 'stairs', self.execute)
        self.server.register_goal_callback(self.on_goal)

    def on_goal(self, goal):
        if 1 <= goal.order <= 20:
            return GoalResponse.ACCEPT
        return GoalResponse.REJECT

    def execute(self, goal_handle):
        goal_handle.succeed()
        return Fibonacci.Result(sequence=range(1, goal_handle.request.order + 1))


lab.spin(Stairs())
