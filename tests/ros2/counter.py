"""Action servers that labkit knows nothing of, for the tests: one that counts, one that refuses.

Prints `ready` when they are there, then each goal that is canceled; ends when its standard input
is closed. `order` is how far it counts; 0 is refused, and 13 is never reached.
"""

import sys
import threading
import time

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from test_msgs.action import Fibonacci


class Counter(Node):
    def __init__(self):
        super().__init__('counter')
        ActionServer(
            self,
            Fibonacci,
            'count',
            self.execute,
            goal_callback=self.on_goal,
            cancel_callback=self.on_cancel,
            callback_group=ReentrantCallbackGroup(),
        )

    def on_goal(self, goal):
        return GoalResponse.ACCEPT if goal.order else GoalResponse.REJECT

    def on_cancel(self, handle):
        return CancelResponse.ACCEPT

    def execute(self, handle):
        result = Fibonacci.Result()
        while handle.request.order == 13 or len(result.sequence) < handle.request.order:
            if handle.is_cancel_requested:
                handle.canceled()
                print(f'canceled {handle.request.order}', flush=True)
                return result
            if len(result.sequence) < 3:
                result.sequence.append(len(result.sequence) + 1)
                handle.publish_feedback(Fibonacci.Feedback(sequence=result.sequence))
            time.sleep(0.02)
        handle.succeed()
        return result


rclpy.init()
executor = MultiThreadedExecutor(4)
executor.add_node(Counter())
threading.Thread(target=lambda: (sys.stdin.read(), rclpy.try_shutdown()), daemon=True).start()
print('ready', flush=True)
try:
    executor.spin()
except ExternalShutdownException:
    pass
