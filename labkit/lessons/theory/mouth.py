"""Exercise: a node that subscribes and publishes."""

from __future__ import annotations

from typing import Any

from labkit.exercises import Exercise, Outcome, Probe, Solution, Style, Wrong, changed, expect
from labkit.lessons._script import in_process

STRING = 'std_msgs/msg/String'


def explain_mouth(sent: Any, came: list[Any]) -> tuple[str, str]:
    """Say what is behind a wrong answer of the mouth."""
    if came and str(came[-1]) == sent['data']:
        return 'The text is passed on as it came.', 'Publish msg.data.upper().'
    if came and sent['data'].upper() not in str(came[-1]):
        return 'What is published does not come from the message.', 'Use msg.data.'
    return '', ''


def judge_mouth(probe: Probe) -> str:
    """Send thoughts, and look at what is said."""
    hears = expect.subscription(probe, '/thought')
    says = expect.publisher(probe, '/speech', by=hears.node)
    found = expect.replies(
        probe,
        hears,
        [{'data': 'i see a cup'}, {'data': 'and a dog'}],
        says,
        lambda sent: sent['data'].upper(),
        explain=explain_mouth,
    )
    expect.node(probe, '/mouth')
    return f'/mouth heard "i see a cup" and said {found[0].values[0]!r}.'


MOUTH = """
from rclpy.node import Node
from std_msgs.msg import String


class Mouth(Node):
    def __init__(self):
        super().__init__('mouth')
        self.publisher = self.create_publisher(String, 'speech', 10)
        self.create_subscription(String, 'thought', self.on_thought, 10)

    def on_thought(self, msg):
        self.publisher.publish(String(data=msg.data.upper()))


mouth = lab.spin(Mouth())
"""

mouth = Exercise(
    name='mouth',
    task='A node mouth repeats each text of /thought on /speech, in capital letters.',
    subscribes={'/thought': STRING},
    publishes={'/speech': STRING},
    nodes=['/mouth'],
    judge=judge_mouth,
    hints=[
        'The class Brain of this lesson subscribes and publishes. So does a mouth.',
        'The text that came in is msg.data; msg.data.upper() is the same in capitals.',
        'Publish in the callback: there the message is at hand.',
    ],
    answer=Solution(
        MOUTH,
        'The callback runs once for each message, so each message gets one answer. The publisher '
        'is made once, in __init__, and used again and again.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String

node = rclpy.create_node('mouth')
speech = node.create_publisher(String, '/speech', 5)


def say(message):
    loud = String()
    loud.data = message.data.upper()
    speech.publish(loud)


node.create_subscription(String, '/thought', say, 5)
lab.spin(node)
""",
        ),
        Style(
            'main() in a process of its own',
            in_process(MOUTH),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'small letters',
            changed(MOUTH, ('msg.data.upper()', 'msg.data')),
            'The text is passed on as it came.',
        ),
        Wrong(
            'capitals of something else',
            changed(MOUTH, ('msg.data.upper()', "'A CUP'")),
            'What is published does not come from the message.',
        ),
        Wrong(
            'talks to itself',
            changed(MOUTH, ("'speech'", "'thought'")),
            'The node hears what it says itself',
        ),
        Wrong(
            'never publishes',
            changed(
                MOUTH, ('self.publisher.publish(String(data=msg.data.upper()))', 'print(msg.data)')
            ),
            'its callback did not publish',
        ),
        Wrong(
            'publishes the text alone',
            changed(MOUTH, ('String(data=msg.data.upper())', 'msg.data.upper()')),
            'publish() takes a message of the type',
            outcome=Outcome.ERROR,
        ),
    ],
)
