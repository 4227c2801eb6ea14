"""Publish odd numbers: every matcher of the graph, of messages and of their values."""

from __future__ import annotations

from labkit.exercises import Exercise, Outcome, Probe, Solution, Style, Wrong, changed, expect
from labkit.lessons._script import in_process, two_copies

INT16 = 'std_msgs/msg/Int16'

NODE = """
from rclpy.node import Node
from std_msgs.msg import Int16


class OddPublisher(Node):
    def __init__(self):
        super().__init__('odd_publisher')
        self.publisher = self.create_publisher(Int16, 'demo_odds', 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.number = 1

    def on_timer(self):
        msg = Int16()
        msg.data = self.number
        self.publisher.publish(msg)
        self.number += 2


lab.spin(OddPublisher())
"""


def judge_count_up(probe: Probe) -> str:
    source = expect.publisher(probe, '/demo_odds')
    odds = expect.messages(probe, source, count=4, hz=10.0)
    expect.each(
        odds,
        'data',
        lambda value: value % 2 == 1,
        expected='odd numbers: 1, 3, 5, ...',
        why='These are even numbers. Adding 2 keeps a number odd only if the first one is odd.',
        todo='Start with 1.',
    )
    expect.steps(odds, 'data', 2)
    expect.first(odds, 'data', 1, 2, why='The count starts with another number than 1.')
    expect.node(probe, '/odd_publisher')
    return f'{source.node} sent {expect.show(odds.values("data"))}'


count_up = Exercise(
    name='count_up',
    task='A node `odd_publisher` that publishes 1, 3, 5, ... on /demo_odds, ten a second.',
    publishes={'/demo_odds': INT16},
    nodes=['/odd_publisher'],
    judge=judge_count_up,
    hints=['Which line runs again and again?', 'A timer of 0.1 s, and self.number += 2.'],
    answer=Solution(NODE, 'The number lives in the node, so it outlives the callback.'),
    styles=[
        Style(
            'functions and a thread',
            """
import threading
import time

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('odd_publisher')
publisher = node.create_publisher(Int16, '/demo_odds', 10)


def work():
    for value in range(1, 3001, 2):
        if not rclpy.ok():
            break
        publisher.publish(Int16(data=value))
        time.sleep(0.1)


threading.Thread(target=work, daemon=True).start()
""",
        ),
        Style(
            'loop with a rate',
            """
import threading

import rclpy
from rclpy.node import Node
from std_msgs.msg import Int16


def main():
    rclpy.init()
    node = Node('odd_publisher')
    publisher = node.create_publisher(Int16, 'demo_odds', 1)
    rate = node.create_rate(10)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    value = -1
    while rclpy.ok():
        value = value + 2
        publisher.publish(Int16(data=value))
        rate.sleep()


threading.Thread(target=main, daemon=True).start()
""",
        ),
        Style(
            'main() in a process of its own',
            in_process(NODE),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'starts at 0',
            changed(NODE, ('self.number = 1', 'self.number = 0')),
            'These are even numbers.',
        ),
        Wrong(
            'starts at 3',
            changed(NODE, ('self.number = 1', 'self.number = 3')),
            'The count starts with another number than 1.',
        ),
        Wrong(
            'never counts',
            changed(NODE, ('self.number += 2', 'number = self.number + 2')),
            'Every message says the same',
            refused='The variable is never used.',
        ),
        Wrong(
            'counts by 4',
            changed(NODE, ('self.number += 2', 'self.number += 4')),
            'The value changes by 4 and not by 2.',
        ),
        Wrong(
            'starts over',
            changed(NODE, ('self.number += 2', 'self.number = (self.number + 2) % 4')),
            'The values start over',
        ),
        Wrong(
            'ten times too slow',
            changed(NODE, ('create_timer(0.1,', 'create_timer(1.0,')),
            'times too slow',
        ),
        Wrong(
            'rate for period',
            changed(NODE, ('create_timer(0.1,', 'create_timer(10,')),
            'its period is 10 s',
        ),
        Wrong(
            'ten times too fast',
            changed(NODE, ('create_timer(0.1,', 'create_timer(0.01,')),
            'times too fast',
        ),
        Wrong(
            'capital letter',
            changed(NODE, ("'demo_odds'", "'demo_Odds'")),
            'Capital and small letters differ',
        ),
        Wrong(
            'private name',
            changed(NODE, ("'demo_odds'", "'~/demo_odds'")),
            'it lies in another namespace',
        ),
        Wrong(
            'misspelt',
            changed(NODE, ("'demo_odds'", "'demo_ods'")),
            'names must be equal to the last letter',
        ),
        Wrong(
            'quite another name',
            changed(NODE, ("'demo_odds'", "'numbers'")),
            'The node works with a topic of another name',
        ),
        Wrong(
            'wrong type',
            changed(NODE, ('Int16', 'Int32')),
            'A topic carries one type of message.',
        ),
        Wrong(
            'forgot to publish',
            changed(NODE, ('self.publisher.publish(msg)', 'pass')),
            'publish() is not called there',
        ),
        Wrong(
            'publishes once',
            changed(
                NODE,
                ('        self.timer = self.create_timer(0.1, self.on_timer)\n', ''),
                ('self.number = 1\n', 'self.number = 1\n        self.on_timer()\n'),
            ),
            'publish() ran once at most',
        ),
        Wrong(
            'not spun',
            changed(NODE, ('lab.spin(OddPublisher())', 'node = OddPublisher()')),
            'nothing runs its callbacks',
        ),
        Wrong(
            'callback called',
            changed(
                NODE,
                ('self.on_timer)', 'self.on_timer())'),
                ('        self.number = 1\n', ''),
                (
                    "super().__init__('odd_publisher')\n",
                    "super().__init__('odd_publisher')\n        self.number = 1\n",
                ),
            ),
            'Pass the name alone, without brackets',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'publisher made in the callback',
            changed(
                NODE,
                (
                    '        msg = Int16()\n',
                    '        self.publisher = '
                    "self.create_publisher(Int16, 'demo_odds', 10)\n        msg = Int16()\n",
                ),
            ),
            'makes a publisher again and again',
        ),
        Wrong(
            'another node on the same topic',
            f"""{NODE}
other = Node('odd_publisher', namespace='copy')
again = other.create_publisher(Int16, '/demo_odds', 10)
""",
            '/copy/odd_publisher in this notebook',
        ),
        Wrong(
            'two copies',
            two_copies(NODE),
            'Two copies of the node run at once',
            process=True,
        ),
        Wrong(
            'value of the wrong kind',
            changed(NODE, ('msg.data = self.number', 'msg.data = str(self.number)')),
            'takes values of type int',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'publishes a number',
            changed(NODE, ('self.publisher.publish(msg)', 'self.publisher.publish(msg.data)')),
            'publish() takes a message of the type',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'other node name',
            changed(NODE, ("'odd_publisher'", "'odds_publisher'")),
            'a node called /odd_publisher',
        ),
    ],
)
