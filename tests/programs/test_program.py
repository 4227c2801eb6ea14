"""Programs of nodes, and their end."""

from __future__ import annotations

PROGRAM = """
import rclpy
from labkit.programs.program import spin_until_interrupted
from rclpy.node import Node
from std_msgs.msg import String

class Speaker(Node):
    def __init__(self):
        super().__init__('speaker')
        self.publisher = self.create_publisher(String, 'news', 10)
        self.create_timer(0.01, self.on_timer)

    def on_timer(self):
        {first}
        self.publisher.publish(String(data='late'))

rclpy.init()
spin_until_interrupted(Speaker())
print('ended, and ROS is', 'up' if rclpy.ok() else 'down')
"""


def test_shut_down_within_a_callback_that_goes_on_publishing(script):
    result = script(PROGRAM.format(first='rclpy.shutdown()'))
    assert (result.stdout, result.stderr) == ('ended, and ROS is down\n', '')


def test_interrupted_within_a_callback(script):
    result = script(PROGRAM.format(first='raise KeyboardInterrupt'))
    assert (result.stdout, result.stderr) == ('ended, and ROS is down\n', '')


def test_a_fault_of_a_callback_is_not_hidden(script):
    result = script(PROGRAM.format(first="raise RuntimeError('a fault')"))
    assert (result.stdout, result.exit_code) == ('', 1)
    assert result.stderr.endswith('RuntimeError: a fault\n')


ANSWER = """
import threading
import labkit as lab
import rclpy
from labkit.programs.program import publish_when_heard
from std_msgs.msg import String

node = lab.spin(rclpy.create_node('asker'))
publisher = node.create_publisher(String, 'answers', 10)
answer = publisher, String(data='yes'), {count}
answering = threading.Thread(target=publish_when_heard, args=answer)
answering.start()
heard = []
for word in ('first', 'second')[:{count}]:
    print(word, answering.is_alive())
    node.create_subscription(String, 'answers', lambda msg: heard.append(msg.data), 10)
answering.join()
lab.wait_until(lambda: len(heard) == {count})
print(heard)
"""


def test_an_answer_waits_for_those_who_are_to_hear_it(script):
    result = script(ANSWER.format(count=1))
    assert (result.stdout, result.stderr) == ("first True\n['yes']\n", '')
    result = script(ANSWER.format(count=2))
    assert result.stdout == "first True\nsecond True\n['yes', 'yes']\n"
