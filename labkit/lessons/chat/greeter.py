"""Exercise: reply in one's own language, by a publisher that is made for it and used once."""

from __future__ import annotations

import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.lessons._script import in_process
from labkit.lessons.chat.clauses import STRING, Replies, UsedOnce

__all__ = ['greeter']

TOPIC = '/lobby'
REPLY = 'Ada: Salut'

_GREETER = """
from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import String


class Greeter(Node):
    def __init__(self):
        super().__init__('greeter')
        self.subscription = self.create_subscription(String, 'lobby', self.on_message, 10)

    def on_message(self, msg):
        if 'Hello' in msg.data:
            publisher = self.create_publisher(String, 'lobby', 10)
            publisher.publish(String(data='Ada: Salut'))
            publisher.wait_for_all_acked(Duration(seconds=1))
            self.destroy_publisher(publisher)


greeter = lab.spin(Greeter())
"""
_IF = "if 'Hello' in msg.data:"
_MADE = "            publisher = self.create_publisher(String, 'lobby', 10)\n"
_GONE = '            self.destroy_publisher(publisher)\n'
_SUBSCRIBED = "self.create_subscription(String, 'lobby', self.on_message, 10)\n"
_PUBLISH = "            publisher.publish(String(data='Ada: Salut'))\n"


def _replies(texts: Sequence[str]) -> list[str | None]:
    return [REPLY if 'Hello' in text else None for text in texts]


def _draw() -> list[str]:
    """Return texts with and without the word, in the middle and in other letters."""
    number = random.randint(10, 99)
    texts = [
        'Bo: Hello',
        f'Chidi: I say Hello to number {number}',
        f'Eva: "Hello{number}"',
        'Hello',
        f'Bo: hello {number}',
        f'Dilek: HELLO {number}',
        f'Eva: Hell o {number}',
        f'Bo: Salut {number}',
        '',
    ]
    random.shuffle(texts)
    # The plainest come first, for a reason that fits. More than ten: some nodes have had enough.
    first = ['Bo: Hello', 'Bo: Hello', f'Bo: Good morning {number}']
    return [*first, *texts, f'Guo: Hello {number}']


def _explain(text: str, came: Sequence[str]) -> tuple[str, str]:
    if 'Hello' not in text:
        if 'hello' in text.lower():
            return (
                'Capital and small letters differ, and the task asks for Hello.',
                "if 'Hello' in msg.data:",
            )
        return 'This message does not say Hello.', "if 'Hello' in msg.data:"
    if not came and text not in ('Hello', 'Bo: Hello'):
        return (
            'This message says Hello, too, and something else beside it.',
            "'Hello' in msg.data tells whether the word is in the text.",
        )
    if not came:
        return (
            'Upon this message nothing came. Is a publisher made, used, and destroyed only then?',
            'Make it in the callback, publish, wait_for_all_acked(), and destroy it then.',
        )
    return '', ''


greeter = Exercise(
    name='greeter',
    task='Reply to Hello on /lobby, each time with a publisher that is made for it.',
    subscribes={TOPIC: STRING},
    publishes={TOPIC: STRING},
    shared=[TOPIC],
    clauses=(
        Replies(
            TOPIC,
            f'for each message on `{TOPIC}` (`{STRING}`) with the word `Hello` in it, publish '
            f'`{REPLY}` on `{TOPIC}`, once, within a second; upon all others nothing',
            _replies,
            _draw,
            _explain,
        ),
        UsedOnce(
            TOPIC,
            'each reply comes from a publisher of its own, which is destroyed afterwards',
        ),
    ),
    hints=[
        'create_publisher() may be called in a callback, too, and not only in __init__.',
        'What was published may be on its way when the publisher goes. wait_for_all_acked() waits '
        'until it has arrived.',
        'In the callback: make the publisher, publish, publisher.wait_for_all_acked(Duration('
        'seconds=1)), self.destroy_publisher(publisher)',
    ],
    answer=Solution(
        _GREETER,
        'The publisher lives in a variable of the callback, for one message. In between, the node '
        'only listens.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from rclpy.duration import Duration
from std_msgs.msg import String

node = rclpy.create_node('polite_one')


def reply(msg):
    if msg.data.find('Hello') < 0:
        return
    mouth = node.create_publisher(String, '/lobby', 1)
    answer = String()
    answer.data = 'Ada: Salut'
    mouth.publish(answer)
    mouth.wait_for_all_acked(Duration(seconds=0.5))
    node.destroy_publisher(mouth)


node.create_subscription(String, '/lobby', reply, 10)
lab.spin(node)
""",
        ),
        Style(
            'a timer waits for subscribers',
            changed(
                _GREETER,
                (
                    f'{_MADE}{_PUBLISH}'
                    '            publisher.wait_for_all_acked(Duration(seconds=1))\n'
                    f'{_GONE}',
                    f'{_MADE}'
                    '            timer = self.create_timer(0.05, lambda: self.reply(publisher, '
                    'timer))\n\n'
                    '    def reply(self, publisher, timer):\n'
                    '        if publisher.get_subscription_count() < self.count_subscribers('
                    "'lobby'):\n"
                    '            return\n'
                    "        publisher.publish(String(data='Ada: Salut'))\n"
                    '        publisher.wait_for_all_acked(Duration(seconds=1))\n'
                    '        self.destroy_timer(timer)\n'
                    '        self.destroy_publisher(publisher)\n',
                ),
            ),
        ),
        Style(
            'try and finally',
            changed(
                _GREETER,
                (
                    f'{_PUBLISH}'
                    '            publisher.wait_for_all_acked(Duration(seconds=1))\n'
                    f'{_GONE}',
                    '            try:\n'
                    "                publisher.publish(String(data='Ada: Salut'))\n"
                    '                publisher.wait_for_all_acked(Duration(seconds=1))\n'
                    '            finally:\n'
                    '                self.destroy_publisher(publisher)\n',
                ),
            ),
        ),
        Style(
            'destroyed by a timer, a moment later',
            changed(
                _GREETER,
                ('            publisher.wait_for_all_acked(Duration(seconds=1))\n', ''),
                ('from rclpy.duration import Duration\n', ''),
                (
                    _GONE,
                    '            timer = self.create_timer(0.5, lambda: self.tidy(publisher, '
                    'timer))\n\n'
                    '    def tidy(self, publisher, timer):\n'
                    '        self.destroy_timer(timer)\n'
                    '        self.destroy_publisher(publisher)\n',
                ),
            ),
        ),
        Style('own process', in_process(_GREETER), process=True),
    ],
    wrong=[
        Wrong(
            'keeps one publisher',
            changed(
                _GREETER,
                (_MADE, ''),
                (_GONE, ''),
                (
                    _SUBSCRIBED,
                    f'{_SUBSCRIBED}        self.publisher = self.create_publisher('
                    "String, 'lobby', 10)\n",
                ),
                ('            publisher.publish', '            self.publisher.publish'),
                ('            publisher.wait', '            self.publisher.wait'),
            ),
            'A publisher that is kept is used again and again.',
        ),
        Wrong(
            'does not destroy it',
            changed(_GREETER, (_GONE, '')),
            'Each reply leaves a publisher behind',
        ),
        Wrong(
            'replies to everything',
            changed(_GREETER, (_IF, "if msg.data != 'Ada: Salut':")),
            'does not say Hello',
        ),
        Wrong(
            'small letters, too',
            changed(_GREETER, (_IF, "if 'hello' in msg.data.lower():")),
            'the task asks for Hello',
        ),
        Wrong(
            'only if it says nothing else',
            changed(_GREETER, (_IF, "if msg.data in ('Hello', 'Bo: Hello'):")),
            'and something else beside it',
        ),
        Wrong(
            'Hello itself, without an end',
            changed(_GREETER, ("'Ada: Salut'", "'Ada: Hello'")),
            'without an end',
        ),
        Wrong(
            'in capital letters',
            changed(_GREETER, ("'Ada: Salut'", "'Ada: SALUT'")),
            'Capital and small letters differ',
        ),
        Wrong(
            'replies twice',
            changed(_GREETER, (_PUBLISH, 2 * _PUBLISH)),
            'It replies more than once.',
        ),
        Wrong(
            'the first time only',
            changed(
                _GREETER,
                (_SUBSCRIBED, f'{_SUBSCRIBED}        self.calls = 0\n'),
                (
                    f'        {_IF}\n',
                    "        self.calls += 'Hello' in msg.data\n"
                    "        if 'Hello' in msg.data and self.calls == 1:\n",
                ),
            ),
            'had a reply before',
        ),
        Wrong(
            'destroys it first',
            changed(_GREETER, (_GONE, ''), (_MADE, f'{_MADE}{_GONE}')),
            'destruction was requested',
            outcome=Outcome.ERROR,
        ),
    ],
)
