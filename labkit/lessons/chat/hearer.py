"""Exercise: show everybody's messages, with who has said them."""

from __future__ import annotations

import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Logs, Subscribes
from labkit.exercises.draws import draw_texts
from labkit.lessons._script import in_process
from labkit.lessons.chat.clauses import STRING

__all__ = ['hearer']

TOPIC = '/hall'
NAMES = ('Bo', 'Chidi', 'Dilek', 'Eva María', 'Çağla', '李娜', 'Dr. O')

_HEARER = """
from rclpy.node import Node
from std_msgs.msg import String


class Hearer(Node):
    def __init__(self):
        super().__init__('hearer')
        self.subscription = self.create_subscription(String, 'hall', self.on_message, 10)

    def on_message(self, msg):
        who, colon, text = msg.data.partition(': ')
        if not colon:
            who, text = 'somebody', msg.data
        self.get_logger().info(f'{who} says {text}')


hearer = lab.spin(Hearer())
"""
_PARTS = "who, colon, text = msg.data.partition(': ')"
_NOBODY = "        if not colon:\n            who, text = 'somebody', msg.data\n"
_LOG = "        self.get_logger().info(f'{who} says {text}')\n"


def _line(message: str) -> str:
    who, colon, text = message.partition(': ')
    return f'{who} says {text}' if colon else f'somebody says {message}'


def _draw() -> list[str]:
    """Return messages with a name, among them some with two colons, and some without a name."""
    texts = [f'{random.choice(NAMES)}: {text}' for text in draw_texts(empty=False)]
    more = [
        f'{random.choice(NAMES)}: at {random.randint(1, 9)}: {random.randint(10, 59)}',
        f'no name {random.randint(1, 99)}',
        f'{random.randint(1, 9)}:{random.randint(10, 59)}',
    ]
    random.shuffle(texts)
    return [*texts[:2], *more, *texts[2:]]


def _explain(message: str, lines: Sequence[str]) -> tuple[str, str]:
    who, colon, text = message.partition(': ')
    line = lines[-1]
    if not colon and 'somebody' not in line:
        return (
            'In this message nobody says who he is: it has no colon with a blank after it.',
            "who, colon, text = msg.data.partition(': '), and look whether colon is empty",
        )
    if message in line:
        return 'That is the message as it came.', "who, colon, text = msg.data.partition(': ')"
    if text.count(': ') and text not in line:
        return (
            'A text may hold a colon, too. The name stands before the first one.',
            "partition(': ') divides at the first one",
        )
    if text and text not in line:
        return 'The text is not the one that came.', "f'{who} says {text}'"
    if who not in line:
        return 'The name is missing.', "f'{who} says {text}'"
    return 'The line is to hold the name, the word says, and the text.', "f'{who} says {text}'"


hearer = Exercise(
    name='hearer',
    task='Log each message of /hall with who has said it.',
    subscribes={TOPIC: STRING},
    clauses=(
        Subscribes(TOPIC, STRING),
        Logs(
            TOPIC,
            'for each message, log one line within a second, and no other line: upon `Bo: Hello` '
            'it holds `Bo says Hello`; the name stands before the first colon with a blank after '
            'it, and upon a message without one, such as `Hello`, the line holds '
            '`somebody says Hello`',
            _draw,
            line=_line,
            explain=_explain,
        ),
    ),
    hints=[
        'A text has a method that divides it at the first place where something stands.',
        "'Bo: Hello'.partition(': ') gives three parts: 'Bo', ': ' and 'Hello'. What are they for "
        "'Hello'?",
        "who, colon, text = msg.data.partition(': '), and if not colon: who, text = 'somebody', "
        'msg.data',
    ],
    answer=Solution(
        _HEARER,
        'partition() divides at the first colon with a blank. If there is none, the second of its '
        'three parts is empty.',
    ),
    styles=[
        Style(
            'functions and split',
            """
import rclpy
from std_msgs.msg import String

node = rclpy.create_node('reporter')


def report(msg):
    parts = msg.data.split(': ', 1)
    if len(parts) == 1:
        parts.insert(0, 'somebody')
    node.get_logger().warning(' says '.join(parts))


node.create_subscription(String, '/hall', report, 1)
lab.spin(node)
""",
        ),
        Style(
            'if and else',
            changed(
                _HEARER,
                (
                    f'        {_PARTS}\n{_NOBODY}{_LOG}',
                    "        if ': ' in msg.data:\n"
                    "            place = msg.data.index(': ')\n"
                    '            who, text = msg.data[:place], msg.data[place + 2 :]\n'
                    '        else:\n'
                    "            who, text = 'somebody', msg.data\n"
                    "        self.get_logger().info(who + ' says ' + text)\n",
                ),
            ),
        ),
        Style(
            'more in the line',
            changed(_HEARER, ("f'{who} says {text}'", "f'In the hall {who} says {text}, I hear'")),
        ),
        Style(
            'a list and a timer',
            changed(
                _HEARER,
                (
                    'self.on_message, 10)\n',
                    'self.note, 10)\n        self.waiting = []\n'
                    '        self.create_timer(0.1, self.on_timer)\n\n'
                    '    def note(self, msg):\n        self.waiting.append(msg)\n\n'
                    '    def on_timer(self):\n        while self.waiting:\n'
                    '            self.on_message(self.waiting.pop(0))\n',
                ),
            ),
        ),
        Style('own process', in_process(_HEARER), process=True),
    ],
    wrong=[
        Wrong(
            'as it came',
            changed(_HEARER, ("f'{who} says {text}'", 'msg.data'), (_NOBODY, '')),
            'That is the message as it came.',
            refused='The parts are made, and not used.',
        ),
        Wrong(
            'nobody for somebody',
            changed(_HEARER, (_NOBODY, '')),
            'nobody says who he is',
            refused='The part colon is made, and not used.',
        ),
        Wrong(
            'divides at the last colon',
            changed(_HEARER, ('.partition(', '.rpartition(')),
            'A text may hold a colon, too.',
        ),
        Wrong(
            'divides at each colon',
            changed(
                _HEARER,
                (
                    _PARTS,
                    "who, *rest = msg.data.split(': ')\n"
                    '        colon, text = rest, rest and rest[0]',
                ),
            ),
            'A text may hold a colon, too.',
        ),
        Wrong(
            'divides at a colon without a blank',
            changed(
                _HEARER,
                (
                    _PARTS,
                    "who, colon, text = msg.data.partition(':')\n        text = text[1:]",
                ),
            ),
            'nobody says who he is',
        ),
        Wrong(
            'without the text',
            changed(_HEARER, ('{who} says {text}', '{who} says {len(text)} letters')),
            'The text is not the one that came.',
        ),
        Wrong(
            'without the name',
            changed(_HEARER, ('{who} says {text}', '{len(who)} letters say {text}')),
            'The name is missing.',
        ),
        Wrong(
            'prints and does not log',
            changed(_HEARER, ('self.get_logger().info(', 'print(')),
            'The callback does not log it.',
        ),
        Wrong(
            'another topic',
            changed(_HEARER, ("'hall'", "'hal'")),
            'subscribes to /hal',
        ),
        Wrong('logs twice', changed(_HEARER, (_LOG, 2 * _LOG)), 'logged more than once'),
        Wrong(
            'leaves out who has no name',
            changed(
                _HEARER,
                ("            who, text = 'somebody', msg.data\n", '            return\n'),
            ),
            'Some messages are logged as they came, and this one is not.',
        ),
        Wrong(
            'a misspelt field',
            changed(_HEARER, ('msg.data.partition', 'msg.text.partition')),
            "no attribute 'text'",
            outcome=Outcome.ERROR,
        ),
    ],
)
