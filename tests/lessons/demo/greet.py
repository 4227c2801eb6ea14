"""Answer each message, and log it: the matchers of a subscription."""

from __future__ import annotations

from collections.abc import Sequence

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Answers, Logs
from labkit.exercises.draws import draw_texts
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


def explain(text: str, came: Sequence[str]) -> tuple[str, str]:
    if came and not came[-1].startswith(text.strip()):
        return 'The text that came in is not used.', 'Put msg.data before the name.'
    return '', ''


greet = Exercise(
    name='greet',
    task='A node that adds Ada to each text of /demo_incomplete and logs what it heard.',
    subscribes={'/demo_incomplete': STRING},
    publishes={'/demo_complete': STRING},
    clauses=[
        Answers(
            '/demo_incomplete',
            '/demo_complete',
            'publish each text on `/demo_complete`, with `Ada` at its end',
            answer=lambda text: f'{text}Ada',
            draw=draw_texts,
            explain=explain,
        ),
        Logs('/demo_incomplete', 'log a line that holds the text', draw_texts),
    ],
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
            'The callback does not log it',
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
            'What stands before .publish is None.',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'raises in the callback',
            changed(GREETER, ('msg.data +', 'msg.text +')),
            'String has nothing called text',
            outcome=Outcome.ERROR,
        ),
    ],
)
