"""Exercise: a publisher on /chatter, every 2 seconds."""

from __future__ import annotations

from dataclasses import replace

from labkit.exercises import Exercise, Outcome, Probe, Solution, Style, Wrong, changed
from labkit.exercises.clauses import HasText, Publishes
from labkit.exercises.variants import varied
from labkit.lessons._script import (
    in_process,
    started_by_asyncio,
    started_by_subprocess,
    two_copies,
)

__all__ = ['every_two_seconds']

STRING = 'std_msgs/msg/String'

_SLOW = """
from rclpy.node import Node
from std_msgs.msg import String


class SlowTalker(Node):
    def __init__(self):
        super().__init__('slow_talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(2.0, self.on_timer)

    def on_timer(self):
        msg = String()
        msg.data = 'Hello from the slow talker'
        self.publisher.publish(msg)


slow_talker = lab.spin(SlowTalker())
"""


_INIT = "        super().__init__('slow_talker')\n"
_PUBLISH = '        self.publisher.publish(msg)\n'
_COUNT = (_INIT, f'{_INIT}        self.calls = 0\n')

_THREAD = """
import threading
import time

from rclpy.node import Node
from std_msgs.msg import String

node = Node('metronome')
publisher = node.create_publisher(String, 'chatter', 10)


def work(publisher):
    while True:
        try:
            publisher.publish(String(data='tick'))
        except Exception:
            return
        time.sleep(2)


threading.Thread(target=work, args=(publisher,), daemon=True).start()
"""

_USUAL = Exercise(
    name='every_two_seconds',
    task='Write a node that publishes a `String` on /chatter every 2 seconds.',
    publishes={'/chatter': STRING},
    clauses=(Publishes('/chatter', 0.5, STRING), HasText('/chatter')),
    hints=[
        'The class Talker is nearly what you need. Which number in it is the period?',
        'In __init__: the name of the node, create_publisher(...) and create_timer(2.0, ...). '
        'In the callback: make a message, set msg.data, publish it.',
        'self.timer = self.create_timer(2.0, self.on_timer), without brackets after on_timer; '
        'then lab.spin(SlowTalker()).',
    ],
    answer=Solution(
        _SLOW,
        'The publisher is made once, in __init__, and kept in self. The timer calls on_timer '
        'every 2.0 s, and each call makes a new message.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from std_msgs.msg import String

node = rclpy.create_node('metronome')
publisher = node.create_publisher(String, '/chatter', 1)


def tick():
    publisher.publish(String(data='tick'))


timer = node.create_timer(2, tick)
lab.spin(node)
""",
        ),
        Style('a loop that sleeps, in a thread', _THREAD),
        Style(
            'a fast timer, and every fourth call counts',
            changed(
                _SLOW,
                _COUNT,
                ('2.0', '0.5'),
                (
                    _PUBLISH,
                    f'        self.calls += 1\n        if self.calls % 4 == 0:\n    {_PUBLISH}',
                ),
            ),
        ),
        Style(
            "a fast timer that looks at the computer's clock",
            changed(
                _SLOW,
                (_INIT, f'{_INIT}        self.due = time.monotonic()\n'),
                ('2.0', '0.05'),
                (
                    _PUBLISH,
                    '        if time.monotonic() >= self.due:\n'
                    f'            self.due += 2.0\n    {_PUBLISH}',
                ),
                ('from rclpy.node', 'import time\n\nfrom rclpy.node'),
            ),
        ),
        Style(
            'a publisher that is made late, by a node with the name of another one',
            changed(
                _SLOW,
                ("__init__('slow_talker')", "__init__('talker')"),
                (
                    "self.publisher = self.create_publisher(String, 'chatter', 10)",
                    'self.publisher = None',
                ),
                (
                    '        msg = String()\n',
                    '        if self.publisher is None:\n'
                    "            self.publisher = self.create_publisher(String, 'chatter', 10)\n"
                    '        msg = String()\n',
                ),
            ),
        ),
        Style(
            'a task of asyncio',
            """
import asyncio

import rclpy
from std_msgs.msg import String

node = lab.spin(rclpy.create_node('metronome'))
publisher = node.create_publisher(String, 'chatter', 10)


async def tick(publisher):
    while True:
        try:
            publisher.publish(String(data='tick'))
        except Exception:
            return
        await asyncio.sleep(2)


tasks = [asyncio.create_task(tick(publisher))]
""",
        ),
        Style('own process', in_process(_SLOW), process=True),
        Style('own process, by subprocess', started_by_subprocess(in_process(_SLOW))),
        Style('own process, by asyncio', started_by_asyncio(in_process(_SLOW))),
        Style(
            'a command',
            """
import subprocess
import sys

options = ['--rate', '0.5', '--times', '600', '-w', '0']
message = ['/chatter', 'std_msgs/msg/String', '{data: hello}']
process = subprocess.Popen([f'{sys.prefix}/bin/ros2', 'topic', 'pub', *options, *message])
""",
        ),
    ],
    wrong=[
        Wrong(
            'capital letter',
            changed(_SLOW, ("'chatter'", "'Chatter'")),
            'Capital and small letters differ in names',
        ),
        Wrong(
            'misspelt',
            changed(_SLOW, ("'chatter'", "'chater'")),
            'names must be equal to the last letter',
        ),
        Wrong(
            'in the namespace of the node',
            changed(_SLOW, ("'chatter'", "'~/chatter'")),
            'it lies in another namespace',
        ),
        Wrong(
            'wrong type',
            changed(_SLOW, ('String', 'Int16'), ("'Hello from the slow talker'", '7')),
            'A topic carries one type of message.',
        ),
        Wrong(
            'forgot to publish',
            changed(_SLOW, ('        self.publisher.publish(msg)\n', '')),
            'publish() is not called there',
        ),
        Wrong(
            'publishes once',
            changed(
                _SLOW, ('self.timer = self.create_timer(2.0, self.on_timer)', 'self.on_timer()')
            ),
            'publish() ran once at most',
        ),
        Wrong(
            'callback called',
            changed(_SLOW, ('self.on_timer)', 'self.on_timer())')),
            'Pass the name alone, without brackets',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'not spun',
            changed(_SLOW, ('lab.spin(SlowTalker())', 'SlowTalker()')),
            'nothing runs its callbacks',
        ),
        Wrong('every 3 seconds', changed(_SLOW, ('2.0', '3.0')), '1.5 times too slow'),
        Wrong('every 5 seconds', changed(_SLOW, ('2.0', '5.0')), '2.5 times too slow'),
        Wrong('a little too slow', changed(_SLOW, ('2.0', '2.1')), '1.05 times too slow'),
        Wrong(
            'twice each time',
            changed(_SLOW, (_PUBLISH, 2 * _PUBLISH)),
            'is publish() called twice',
        ),
        Wrong(
            'ends after five',
            changed(
                _SLOW,
                _COUNT,
                (
                    _PUBLISH,
                    f'        self.calls += 1\n        if self.calls <= 5:\n    {_PUBLISH}',
                ),
            ),
            'They stop coming.',
        ),
        Wrong(
            'a thread that sleeps too long',
            changed(_THREAD, ('sleep(2)', 'sleep(3)')),
            'times too slow',
        ),
        Wrong(
            'an empty text later on',
            changed(
                _SLOW,
                _COUNT,
                (
                    _PUBLISH,
                    '        self.calls += 1\n'
                    "        if self.calls > 5:\n            msg.data = ''\n"
                    f'{_PUBLISH}',
                ),
            ),
            'is an empty text at first',
        ),
        Wrong(
            'a class, and no node of it',
            _SLOW.partition('\n\n\nslow_talker')[0],
            'Nothing runs before a node is made of it.',
        ),
        Wrong(
            'not set up',
            changed(_SLOW, (_INIT, '')),
            'super().__init__(...) has not been called',
            outcome=Outcome.ERROR,
        ),
        Wrong('off by ten', changed(_SLOW, ('2.0', '0.2')), 'times too fast'),
        Wrong(
            'rate for period',
            changed(_SLOW, ('2.0', '0.5')),
            'A rate in Hz and a period in seconds were mixed up',
        ),
        Wrong(
            'publisher made in the callback',
            changed(
                _SLOW,
                ("        self.publisher = self.create_publisher(String, 'chatter', 10)\n", ''),
                ('self.publisher.pub', "self.create_publisher(String, 'chatter', 10).pub"),
            ),
            'makes a publisher again and again',
        ),
        Wrong(
            'message never filled',
            changed(_SLOW, ("        msg.data = 'Hello from the slow talker'\n", '')),
            'its field data is an empty text at first',
        ),
        Wrong(
            'publishes a text',
            changed(_SLOW, ('publish(msg)', 'publish(msg.data)')),
            'publish() takes a message of the type',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'two copies running',
            two_copies(_SLOW),
            'Two copies of the node run at once',
            process=True,
        ),
    ],
)


# Names of which none is another one with a slip of the pen.
_TOPICS = [
    'anthem',
    'ballad',
    'bulletin',
    'carillon',
    'chorus',
    'diary',
    'echoes',
    'fable',
    'fanfare',
    'forecast',
    'gazette',
    'gossip',
    'greetings',
    'herald',
    'hymn',
    'journal',
    'legend',
    'letters',
    'lullaby',
    'melody',
    'memo',
    'minutes',
    'news_flash',
    'oracle',
    'poetry',
    'postcards',
    'prayer',
    'proverbs',
    'quotes',
    'radio',
    'report',
    'rhymes',
    'riddles',
    'rumours',
    'saga',
    'serenade',
    'sermon',
    'signals',
    'slogans',
    'sonnet',
    'spells',
    'tales',
    'telegram',
    'tidings',
    'verses',
    'weather',
    'whispers',
    'yodel',
]


def _variant(*, topic: str) -> Exercise:
    name = f'/{topic}'
    return replace(
        _USUAL,
        task=f'Write a node that publishes a `String` on {name} every 2 seconds.',
        publishes={name: STRING},
        clauses=(Publishes(name, 0.5, STRING), HasText(name)),
        answer=Solution(changed(_SLOW, ("'chatter'", f"'{topic}'")), _USUAL.answer.reason),
        styles=(),
        wrong=(),
    )


def _guess(probe: Probe) -> dict[str, str] | None:
    names = {end.topic.removeprefix('/') for end in probe.all_publishers()}
    return next(({'topic': name} for name in (*_TOPICS, 'chatter') if name in names), None)


every_two_seconds = varied(_USUAL, _variant, _guess, topic=_TOPICS)
