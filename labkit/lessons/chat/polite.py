"""Exercise: greet each person once, so that two who do so come to an end."""

from __future__ import annotations

import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.lessons._script import in_process
from labkit.lessons.chat.clauses import STRING, Replies, split

__all__ = ['polite']

TOPIC = '/lounge'
NAMES = ('Bo', 'Chidi', 'Dilek', 'Eva', 'Finn', 'Guo', 'Hana')
ME = 'Ada'

_POLITE = """
from rclpy.node import Node
from std_msgs.msg import String


class Polite(Node):
    def __init__(self):
        super().__init__('polite')
        self.greeted = {'Ada'}
        self.publisher = self.create_publisher(String, 'lounge', 10)
        self.subscription = self.create_subscription(String, 'lounge', self.on_message, 10)

    def on_message(self, msg):
        who, _, text = msg.data.partition(': ')
        if 'Hello' in text and who not in self.greeted:
            self.greeted.add(who)
            self.publisher.publish(String(data=f'Ada: Hello, {who}'))


polite = lab.spin(Polite())
"""
_IF = "if 'Hello' in text and who not in self.greeted:"
_ADD = '            self.greeted.add(who)\n'
_SAID = "f'Ada: Hello, {who}'"


def _replies(texts: Sequence[str]) -> list[str | None]:
    greeted, replies = {ME}, []
    for message in texts:
        who, text = split(message)
        due = 'Hello' in text and who not in greeted
        replies.append(f'{ME}: Hello, {who}' if due else None)
        greeted |= {who} if due else set()
    return replies


def _draw() -> list[str]:
    """Return what people say whom nobody knows yet: each has a number of its own."""
    number = iter(random.sample(range(100, 1000), 12))
    bo, chidi, eva, finn, *more = [f'{name}{next(number)}' for name in (*NAMES, *NAMES[:5])]
    return [
        f'{bo}: Hello',
        f'{chidi}: How are you?',
        f'{bo}: Hello again',
        f'{chidi}: Well, Hello',
        f'{eva}: Hello, {ME}',
        f'{eva}: Hello, {ME}',
        f'{finn}: {bo} says Hi',
        f'{bo}: Hello, {finn}',
        f'{ME}: Hello',
        *(f'{name}: Hello' for name in more),
        f'{finn}: Hello',
        f'{chidi}: Hello',
    ]


def _explain(message: str, came: Sequence[str]) -> tuple[str, str]:
    who, text = split(message)
    if came and who == ME:
        return 'That was said by Ada herself.', f'Leave out what {ME} has said: who != {ME!r}'
    if came and 'Hello' not in text:
        return 'This message does not say Hello.', "if 'Hello' in text"
    if came and f'{ME}: Hello, {who}' in came:
        return (
            f'{who} was greeted before. Two nodes that always reply never come to an end.',
            'Keep the names of those whom you have greeted, in a set: self.greeted.add(who)',
        )
    if came:
        return '', ''
    return (
        f'{who} says Hello and was not greeted yet.',
        'Greet each one at the first Hello, and only then put the name into the set.',
    )


polite = Exercise(
    name='polite',
    task='Greet each person on /lounge once, at the first Hello.',
    subscribes={TOPIC: STRING},
    publishes={TOPIC: STRING},
    shared=[TOPIC],
    clauses=(
        Replies(
            TOPIC,
            f'messages on `{TOPIC}` (`{STRING}`) are a name, a colon, a blank and a text; when a '
            'text has the word `Hello` in it for the first time from a name, publish '
            f'`{ME}: Hello, ` and that name, within a second; upon all others, and what {ME} has '
            'said herself, publish nothing',
            _replies,
            _draw,
            _explain,
        ),
    ),
    hints=[
        'A node hears what it publishes itself, if it subscribes to the same topic.',
        'A set holds each thing once: greeted = set(), greeted.add(who), who in greeted',
        "if 'Hello' in text and who not in self.greeted: with {'Ada'} in it from the beginning",
    ],
    answer=Solution(
        _POLITE,
        'The set remembers who was greeted. With their own name in it from the beginning, nobody '
        'greets himself.',
    ),
    styles=[
        Style(
            'functions and a list',
            """
import rclpy
from std_msgs.msg import String

node = rclpy.create_node('host')
publisher = node.create_publisher(String, '/lounge', 10)
known = []


def greet(msg):
    who = msg.data.split(': ')[0]
    said = msg.data[len(who) + 2 :]
    if who == 'Ada' or 'Hello' not in said or who in known:
        return
    known.append(who)
    publisher.publish(String(data='Ada: Hello, ' + who))


node.create_subscription(String, '/lounge', greet, 10)
lab.spin(node)
""",
        ),
        Style(
            'a dictionary that counts',
            changed(
                _POLITE,
                ("{'Ada'}", "{'Ada': 1}"),
                (_ADD, '            self.greeted[who] = 1\n'),
            ),
        ),
        Style(
            'a list and a timer',
            changed(
                _POLITE,
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
        Style(
            'a queue and a thread',
            changed(
                _POLITE,
                ('\nfrom rclpy', '\nimport queue\nimport threading\n\nfrom rclpy'),
                (
                    'self.on_message, 10)\n',
                    'self.heard.put, 10)\n'
                    '        threading.Thread(target=self.work, daemon=True).start()\n\n'
                    '    def work(self):\n        while True:\n'
                    '            msg = self.heard.get()\n'
                    '            sum(range(1_000_000))  # it takes its time\n'
                    '            self.on_message(msg)\n',
                ),
                (
                    "        self.greeted = {'Ada'}\n",
                    "        self.greeted = {'Ada'}\n        self.heard = queue.Queue()\n",
                ),
            ),
        ),
        Style(
            'greets before it remembers',
            changed(
                _POLITE,
                (
                    f'{_ADD}            self.publisher.publish(String(data={_SAID}))\n',
                    f'            self.publisher.publish(String(data={_SAID}))\n{_ADD}',
                ),
            ),
        ),
        Style('own process', in_process(_POLITE), process=True),
    ],
    wrong=[
        Wrong(
            'greets each time',
            changed(_POLITE, (_ADD, '')),
            'was greeted before',
        ),
        Wrong(
            'greets itself, without an end',
            changed(_POLITE, (_IF, "if 'Hello' in text:"), (_ADD, '')),
            'without an end',
        ),
        Wrong(
            'greets itself once',
            changed(_POLITE, ("{'Ada'}", 'set()')),
            'What it has said itself comes to it',
        ),
        Wrong(
            'replies to everything',
            changed(_POLITE, ("'Hello' in text and ", 'msg.data != text and ')),
            'does not say Hello',
        ),
        Wrong(
            'remembers who said nothing yet',
            changed(
                _POLITE,
                (
                    f'        {_IF}\n{_ADD}',
                    '        new = who not in self.greeted\n        self.greeted.add(who)\n'
                    "        if 'Hello' in text and new:\n",
                ),
            ),
            'says Hello and was not greeted yet',
        ),
        Wrong(
            'one for all',
            changed(
                _POLITE,
                (_IF, "if 'Hello' in text and len(self.greeted) == 1:"),
            ),
            'says Hello and was not greeted yet',
        ),
        Wrong(
            'without the name',
            changed(_POLITE, (_SAID, "'Ada: Hello'")),
            'Ada: Hello, ',
        ),
        Wrong(
            'ten people and no more',
            changed(_POLITE, (_IF, f'{_IF[:-1]} and len(self.greeted) < 5:')),
            'says Hello and was not greeted yet',
        ),
        Wrong(
            'greets twice',
            changed(
                _POLITE,
                (
                    f'            self.publisher.publish(String(data={_SAID}))\n',
                    '            for _ in range(2):\n'
                    f'                self.publisher.publish(String(data={_SAID}))\n',
                ),
            ),
            'It replies more than once.',
        ),
        Wrong(
            'a list that is not there',
            changed(_POLITE, ('self.greeted.add', 'self.known.add')),
            "no attribute 'known'",
            outcome=Outcome.ERROR,
        ),
    ],
)
