"""Exercise: a node that subscribes and publishes."""

from __future__ import annotations

from collections.abc import Sequence

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Answers, Named
from labkit.exercises.draws import draw_texts
from labkit.lessons._script import in_process, started_by_asyncio, started_by_subprocess

__all__ = ['mouth']

STRING = 'std_msgs/msg/String'

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
_PUBLISH = '        self.publisher.publish(String(data=msg.data.upper()))\n'
_SUBSCRIBE = "        self.create_subscription(String, 'thought', self.on_thought, 10)\n"


def explain_mouth(text: str, came: Sequence[str]) -> tuple[str, str]:
    """Say what is behind a wrong answer of the mouth."""
    if not came:
        return '', ''
    said = came[-1]
    if said == text:
        return 'The text is passed on as it came.', 'Publish msg.data.upper().'
    if said == text.lower():
        return 'lower() makes small letters.', 'Publish msg.data.upper().'
    if said in (text.capitalize(), text.title()):
        return 'Only first letters have become capital ones.', 'Publish msg.data.upper().'
    if said.upper() == text.upper():
        return 'Not all letters have become capital ones.', 'Publish msg.data.upper().'
    if said.strip().upper() == text.strip().upper() != '':
        return '', ''
    if not text or text.upper() not in said:
        return 'What is published does not come from the message.', 'Use msg.data.'
    return '', ''


mouth = Exercise(
    name='mouth',
    task='A node mouth repeats each text of /thought on /speech, in capital letters.',
    subscribes={'/thought': STRING},
    publishes={'/speech': STRING},
    nodes=['/mouth'],
    clauses=(
        Named('/mouth'),
        Answers(
            '/thought',
            '/speech',
            'for each text on `/thought`, publish the same text in capital letters on `/speech` '
            '(both `std_msgs/msg/String`), once, within a second',
            answer=str.upper,
            draw=draw_texts,
            by='/mouth',
            explain=explain_mouth,
        ),
    ),
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
            'a list and a timer',
            changed(
                MOUTH,
                (
                    _SUBSCRIBE,
                    '        self.waiting = []\n'
                    + _SUBSCRIBE.replace('on_thought', 'waiting.append')
                    + '        self.create_timer(0.1, self.speak)\n',
                ),
                (
                    f'    def on_thought(self, msg):\n{_PUBLISH}',
                    '    def speak(self):\n'
                    '        while self.waiting:\n'
                    '            msg = self.waiting.pop(0)\n'
                    f'    {_PUBLISH}',
                ),
            ),
        ),
        Style(
            'a queue and a thread',
            """
import queue
import threading

import rclpy
from std_msgs.msg import String

node = rclpy.create_node('mouth')
speech = node.create_publisher(String, 'speech', 10)
thoughts = queue.Queue()
node.create_subscription(String, 'thought', thoughts.put, 10)


def speak():
    while True:
        text = thoughts.get().data.upper()
        try:
            speech.publish(String(data=text))
        except Exception:
            return


threading.Thread(target=speak, daemon=True).start()
lab.spin(node)
""",
        ),
        Style(
            'an executor with several threads',
            changed(
                MOUTH,
                (
                    'from rclpy.node import Node\n',
                    'import threading\n\nfrom rclpy.executors import MultiThreadedExecutor\n'
                    'from rclpy.node import Node\n',
                ),
                (
                    'mouth = lab.spin(Mouth())\n',
                    'executor = MultiThreadedExecutor()\nexecutor.add_node(Mouth())\n'
                    'threading.Thread(target=executor.spin, daemon=True).start()\n',
                ),
            ),
        ),
        Style(
            'renamed from outside, and with another QoS profile',
            changed(
                MOUTH,
                (
                    "'mouth')",
                    "'node', cli_args=OPTIONS)",
                ),
                ("'thought'", "'a'"),
                ("'speech', 10", "'speech', latched"),
                (
                    '\n\nclass',
                    '\nlatched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)'
                    "\nOPTIONS = ['--ros-args', '-r', '__node:=mouth', '-r', 'a:=thought']"
                    '\n\n\nclass',
                ),
                (
                    'from std_msgs',
                    'from rclpy.qos import DurabilityPolicy, QoSProfile\nfrom std_msgs',
                ),
            ),
        ),
        Style('main() in a process of its own', in_process(MOUTH), process=True),
        Style('a process, by subprocess', started_by_subprocess(in_process(MOUTH))),
        Style('a process, by asyncio', started_by_asyncio(in_process(MOUTH))),
    ],
    wrong=[
        Wrong(
            'small letters',
            changed(MOUTH, ('msg.data.upper()', 'msg.data')),
            'The text is passed on as it came.',
        ),
        Wrong(
            'lower for upper',
            changed(MOUTH, ('upper()', 'lower()')),
            'Next: Publish msg.data.upper().',
        ),
        Wrong(
            'only the first letters',
            changed(MOUTH, ('upper()', 'title()')),
            'Only first letters have become capital ones.',
        ),
        Wrong(
            'capitals of something else',
            changed(MOUTH, ('msg.data.upper()', "'A CUP'")),
            'What is published does not come from the message.',
        ),
        Wrong(
            'English letters only',
            changed(
                MOUTH,
                (
                    _PUBLISH,
                    "        text = ''.join(c.upper() if c.isascii() else c for c in msg.data)\n"
                    '        self.publisher.publish(String(data=text))\n',
                ),
            ),
            'Not all letters have become capital ones.',
        ),
        Wrong(
            'not the empty text',
            changed(MOUTH, (_PUBLISH, f'        if msg.data:\n    {_PUBLISH}')),
            'others not',
        ),
        Wrong(
            'without the spaces at the ends',
            changed(MOUTH, ('upper()', 'strip().upper()')),
            'A space is a character like any other.',
        ),
        Wrong(
            'only the first time',
            changed(
                MOUTH,
                (_SUBSCRIBE, f'{_SUBSCRIBE}        self.calls = 0\n'),
                (
                    _PUBLISH,
                    '        self.calls += 1\n        loud = msg.data.upper()\n'
                    '        text = loud if self.calls == 1 else msg.data\n'
                    '        self.publisher.publish(String(data=text))\n',
                ),
            ),
            'The text is passed on as it came.',
        ),
        Wrong(
            'says it twice',
            changed(MOUTH, (_PUBLISH, 2 * _PUBLISH)),
            'A message is answered more than once.',
        ),
        Wrong(
            'echoes and answers',
            changed(MOUTH, (_PUBLISH, f'        self.publisher.publish(msg)\n{_PUBLISH}')),
            'What came in goes out as well, as it is, beside the answer.',
        ),
        Wrong(
            'repeats its last answer from a timer',
            changed(
                MOUTH,
                (
                    _SUBSCRIBE,
                    f"{_SUBSCRIBE}        self.last = ''\n"
                    '        self.create_timer(1.0, self.speak)\n',
                ),
                (
                    _PUBLISH,
                    '        self.last = msg.data.upper()\n\n    def speak(self):\n'
                    '        self.publisher.publish(String(data=self.last))\n',
                ),
            ),
            'The answer is repeated, again and again',
        ),
        Wrong(
            'answers another topic, too',
            changed(MOUTH, (_SUBSCRIBE, _SUBSCRIBE + _SUBSCRIBE.replace("'thought'", "'sight'"))),
            'What comes on /sight is answered, too.',
        ),
        Wrong(
            'ends after three',
            changed(
                MOUTH,
                (_SUBSCRIBE, f'{_SUBSCRIBE}        self.left = 3\n'),
                (
                    _PUBLISH,
                    f'        self.left -= 1\n        if self.left >= 0:\n    {_PUBLISH}',
                ),
            ),
            'others not',
        ),
        Wrong(
            'speaks much later',
            changed(
                MOUTH,
                (
                    _SUBSCRIBE,
                    '        self.waiting = []\n'
                    + _SUBSCRIBE.replace('on_thought', 'waiting.append')
                    + '        self.create_timer(7.0, self.speak)\n',
                ),
                (
                    f'    def on_thought(self, msg):\n{_PUBLISH}',
                    '    def speak(self):\n'
                    '        while self.waiting:\n'
                    '            msg = self.waiting.pop(0)\n'
                    f'    {_PUBLISH}',
                ),
            ),
            'within a second',
        ),
        Wrong(
            'talks to itself',
            changed(MOUTH, ("'speech'", "'thought'")),
            'The node hears what it says itself',
        ),
        Wrong(
            'never publishes',
            changed(MOUTH, (_PUBLISH, '        print(msg.data)\n')),
            'its callback did not publish',
        ),
        Wrong(
            'publishes the text alone',
            changed(MOUTH, ('String(data=msg.data.upper())', 'msg.data.upper()')),
            'publish() takes a message of the type',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'not spun',
            changed(MOUTH, ('lab.spin(Mouth())', 'Mouth()')),
            '/mouth is there, but it is not spun',
        ),
        Wrong(
            'a program that does not spin',
            changed(
                in_process(MOUTH),
                (
                    'rclpy.spin(Mouth())',
                    'mouth = Mouth()\n    time.sleep(60)\n    mouth.destroy_node()',
                ),
                ('import rclpy\nfrom', 'import time\n\nimport rclpy\nfrom'),
            ),
            'Call rclpy.spin(node) in its program.',
            process=True,
        ),
        Wrong(
            'hears nothing of usual publishers',
            changed(
                MOUTH,
                ('on_thought, 10)', 'on_thought, latched)'),
                (
                    '\n\nclass',
                    '\nlatched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)'
                    '\n\n\nclass',
                ),
                (
                    'from std_msgs',
                    'from rclpy.qos import DurabilityPolicy, QoSProfile\nfrom std_msgs',
                ),
            ),
            'QoS profiles do not match',
        ),
        Wrong(
            'another name',
            changed(MOUTH, ("__init__('mouth')", "__init__('mouse')")),
            "The name is what super().__init__() gets: 'mouth'.",
        ),
        Wrong(
            'not set up',
            changed(MOUTH, ("        super().__init__('mouth')\n", '')),
            'super().__init__(...) has not been called',
            outcome=Outcome.ERROR,
        ),
    ],
)
