from rclpy.action import ActionServer, CancelResponse
from rclpy.node import Node
from rclpy.task import Future
from test_msgs.action import Fibonacci

import labkit as lab


class Countdown(Node):
    def __init__(self):
        super().__init__('countdown')
        self.server = ActionServer(self, Fibonacci, 'countdown', self.execute)
        self.server.register_cancel_callback(self.on_cancel)
        self.tick = Future()
        self.timer = self.create_timer(0.05, self.on_timer)

    def on_timer(self):
        self.tick.set_result(True)

    def on_cancel(self, goal_handle):
        return CancelResponse.ACCEPT

    async def execute(self, goal_handle):
        numbers = []
        for number in range(goal_handle.request.order, -1, -1):
            self.tick = Future()
            await self.tick
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return Fibonacci.Result(sequence=numbers)
            numbers.append(number)
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        goal_handle.succeed()
        return Fibonacci.Result(sequence=numbers)


lab.spin(Countdown())
