"""What becomes of an action's end that is destroyed in the moment when something waits there."""

from __future__ import annotations

CODE = """
import threading
import labkit as lab
from action_msgs.msg import GoalStatusArray
from labkit.background.runtime import runtime
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import qos_profile_action_status_default
from test_msgs.action import Fibonacci

seen = threading.Event()

class Client(ActionClient):
    def is_ready(self, wait_set):
        ready = super().is_ready(wait_set)
        if ready:
            seen.set()
        return ready

node = lab.spin(Node('asker'))
client = Client(node, Fibonacci, 'count')
server = node.create_publisher(
    GoalStatusArray, 'count/_action/status', qos_profile_action_status_default
)
with runtime.executor.between_callbacks():
    server.publish(GoalStatusArray())
    print(seen.wait(60))
    client.destroy()
print(runtime.executor.settle(60))
"""


def test_one_that_is_destroyed_is_no_error(script):
    result = script(CODE)
    assert (result.stdout, result.stderr) == ('True\nTrue\n', '')
