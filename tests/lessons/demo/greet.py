"""Answer each message, and log it: the matchers of a subscription."""

from __future__ import annotations

from typing import Any

from labkit.exercises import Exercise, Outcome, Probe, Solution, Style, Wrong, changed, expect
from labkit.lessons._script import in_process

STRING = 'std_msgs/msg/String'

GREETER = """
from rclpy.node import Node
from std_msgs.msg import String


class Greeter(Node):
    def __init__(self):
        super().__init__('greeter')
        self.publisher = self.create_publisher(String, 'demo_complete', 10)
        self.subscription = self.create_subscription(String, 'demo_incomplete', self.on_text, 10)

    def on_text(self, msg):
        self.get_logger().info(f'I heard: {msg.data}')
        reply = String(data=msg.data + 'Ada')
        self.publisher.publish(reply)


lab.spin(Greeter())
"""


def explain(sent: Any, came: list[Any]) -> tuple[str, str]:
    if came and not str(came[-1]).startswith(sent['data'].strip()):
        return 'The text that came in is not used.', 'Put msg.data before the name.'
    return '', ''


def judge_greet(probe: Probe) -> str:
    hears = expect.subscription(probe, '/demo_incomplete')
    says = expect.publisher(probe, '/demo_complete', by=hears.node)
    found = expect.replies(
        probe,
        hears,
        [{'data': 'My name is '}, {'data': 'I am '}],
        says,
        lambda sent: sent['data'] + 'Ada',
        explain=explain,
    )
    line = expect.logs(probe, hears.node, hears, {'data': 'Call me '}, 'Call me ')
    return f'{found[0].values[0]!r}, {line!r}'


greet = Exercise(
    name='greet',
    task='A node that adds Ada to each text of /demo_incomplete and logs what it heard.',
    subscribes={'/demo_incomplete': STRING},
    publishes={'/demo_complete': STRING},
    judge=judge_greet,
    hints=['The answer is sent in the callback.', 'reply.data = msg.data + "Ada"'],
    answer=Solution(GREETER, 'The callback is where the text is.'),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String

node = rclpy.create_node('another_name')
pub = node.create_publisher(String, '/demo_complete', 1)


def answer(m):
    pub.publish(String(data=f'{m.data}Ada'))
    node.get_logger().warning('got ' + m.data)


node.create_subscription(String, '/demo_incomplete', answer, 1)
lab.spin(node)
""",
        ),
        Style(
            'main() in a process of its own',
            in_process(GREETER),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'space missing',
            changed(GREETER, ("msg.data + 'Ada'", "msg.data.strip() + 'Ada'")),
            'The spaces are not where they should be',
        ),
        Wrong(
            'made once',
            changed(GREETER, ("msg.data + 'Ada'", "'My name is Ada'")),
            'The text that came in is not used.',
        ),
        Wrong(
            'answers where it listens',
            changed(GREETER, ("'demo_complete'", "'demo_incomplete'")),
            'The node hears what it says itself',
        ),
        Wrong(
            'does not publish',
            changed(
                GREETER,
                ("        reply = String(data=msg.data + 'Ada')\n", ''),
                ('        self.publisher.publish(reply)\n', ''),
            ),
            'its callback did not publish',
        ),
        Wrong(
            'blocks',
            changed(
                GREETER,
                ('        reply =', '        sleep(3)\n        reply ='),
                ('from rclpy', 'from time import sleep\n\nfrom rclpy'),
            ),
            'While a callback runs, no other one can',
        ),
        Wrong(
            'does not log',
            changed(
                GREETER, ("self.get_logger().info(f'I heard: {msg.data}')", 'print(msg.data)')
            ),
            'The callback does not log',
        ),
        Wrong(
            'callback without a message',
            changed(GREETER, ('def on_text(self, msg)', 'def on_text(self)')),
            'This callback does not take one argument',
            outcome=Outcome.ERROR,
            refused='The name msg is not defined.',
        ),
        Wrong(
            'no publisher',
            changed(GREETER, ("self.create_publisher(String, 'demo_complete', 10)", 'None')),
            'create_publisher() for this topic has not been called',
        ),
        Wrong(
            'raises in the callback',
            changed(GREETER, ('msg.data +', 'msg.text +')),
            'String has nothing called text',
            outcome=Outcome.ERROR,
        ),
    ],
)
