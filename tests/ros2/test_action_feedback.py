"""The hidden topic of an action's feedback, where a person asks for it."""

from __future__ import annotations

FEEDBACK = """
import labkit as lab
lab.start()
from labkit.ros2.shell import run_line
from rclpy.action import ActionServer
from rclpy.node import Node
from test_msgs.action import Fibonacci

node = Node('counter')
ActionServer(node, Fibonacci, '/count', print)
publisher = node.create_publisher(
    Fibonacci.Impl.FeedbackMessage, '/count/_action/feedback', 10)
message = Fibonacci.Impl.FeedbackMessage(feedback=Fibonacci.Feedback(sequence=[3, 4]))
node.create_timer(0.02, lambda: publisher.publish(message))
lab.spin(node)
run_line('topic echo /count/_action/feedback --once --field feedback')
print(lab.monitor('/count/_action/feedback'))
print(lab.plot('/count/_action/feedback.feedback.sequence[1]'))
print(lab.wait_for_message('/count/_action/feedback', Fibonacci.Impl.FeedbackMessage).feedback)
"""


def test_feedback_is_echoed_monitored_and_plotted(script):
    result = script(FEEDBACK)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.startswith('sequence:\n- 3\n- 4\n---\n'), result.stdout + result.stderr
    assert 'Fibonacci_FeedbackMessage' in result.stdout
    assert 'Fibonacci_Feedback(sequence=[3, 4])' in result.stdout
    assert 'no message' not in result.stdout
