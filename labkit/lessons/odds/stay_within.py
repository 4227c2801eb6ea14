"""Exercise: stop, or start over, before a number does not fit any more."""

from __future__ import annotations

from labkit.exercises import (
    Exercise,
    Outcome,
    Solution,
    Style,
    Wrong,
    changed,
)
from labkit.exercises.clauses import Messages
from labkit.lessons._script import in_process, started_by_subprocess
from labkit.lessons.odds.stay_within_clauses import (
    FIRST,
    LARGEST,
    TOPIC,
    AfterTheLimit,
    Run,
    up_to_the_limit,
)

__all__ = ['stay_within']

INT16 = 'std_msgs/msg/Int16'

_LATE = """
from rclpy.node import Node
from std_msgs.msg import Int16


class LateOdds(Node):
    def __init__(self, first=1):
        super().__init__('late_odds')
        self.publisher = self.create_publisher(Int16, 'late_odds', 10)
        self.timer = self.create_timer(0.1, self.on_timer)
        self.number = first

    def on_timer(self):
        self.publisher.publish(Int16(data=self.number))
        self.number += 2
        if self.number > 32767:
            self.number = 1


late_odds = lab.spin(LateOdds(first=32751))
"""
_GUARD = '        if self.number > 32767:\n            self.number = 1\n'


stay_within = Exercise(
    name='stay_within',
    task=f'Publish odd numbers on {TOPIC}, ten a second, from {FIRST} on. After {LARGEST} stop, '
    'or start over with 1.',
    publishes={TOPIC: INT16},
    clauses=(
        Run(TOPIC, 10.0, INT16),
        Messages(
            TOPIC,
            f'the numbers are {FIRST}, {FIRST + 2}, {FIRST + 4}, ..., {LARGEST}, one a message; '
            f'{LARGEST - 2} as the last one is right, too',
            up_to_the_limit,
        ),
        AfterTheLimit(),
    ),
    hints=[
        f'Which number comes after {LARGEST} when you add 2? Does it fit into an Int16?',
        'Look at the number after you have added 2, and before it is published.',
        f'if self.number > {LARGEST}: self.number = 1. To stop instead: self.timer.cancel().',
    ],
    answer=Solution(
        _LATE,
        'The number is put right before it is published, so no message is ever refused. That the '
        'first number is an argument makes the limit easy to try: nobody waits for 16000 '
        'messages.',
    ),
    styles=[
        Style('remainder', changed(_LATE, (_GUARD, '        self.number %= 32768\n'))),
        Style(
            'stops',
            changed(_LATE, ('            self.number = 1\n', '            self.timer.cancel()\n')),
        ),
        Style(
            'functions, and 32765 is the last',
            """
import itertools

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('counter')
publisher = node.create_publisher(Int16, '/late_odds', 10)
numbers = itertools.chain(range(32751, 32767, 2), itertools.cycle(range(1, 32767, 2)))
node.create_timer(0.1, lambda: publisher.publish(Int16(data=next(numbers))))
lab.spin(node)
""",
        ),
        Style(
            'a loop that sleeps, in a thread, and ends',
            """
import threading
import time

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('sleeper')
publisher = node.create_publisher(Int16, 'late_odds', 10)


def work(publisher):
    for number in range(32751, 32768, 2):
        publisher.publish(Int16(data=number))
        time.sleep(0.1)


threading.Thread(target=work, args=[publisher], daemon=True).start()
""",
        ),
        Style(
            'a loop that sleeps, in a thread, and starts over',
            """
import threading
import time

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('sleeper')
publisher = node.create_publisher(Int16, 'late_odds', 10)


def work(publisher):
    number = 32751
    while rclpy.ok():
        publisher.publish(Int16(data=number))
        number = number + 2 if number < 32767 else 1
        time.sleep(0.1)


threading.Thread(target=work, args=[publisher], daemon=True).start()
""",
        ),
        Style(
            'a fast timer, and every fifth call counts',
            changed(
                _LATE,
                (
                    '        self.number = first\n',
                    '        self.number = first\n        self.n = 0\n',
                ),
                ('create_timer(0.1,', 'create_timer(0.02,'),
                (
                    '    def on_timer(self):\n',
                    '    def on_timer(self):\n        self.n += 1\n'
                    '        if self.n % 5 != 1:\n            return\n',
                ),
            ),
        ),
        Style(
            'the check comes when the count has ended',
            changed(_LATE, ('            self.number = 1\n', '            self.timer.cancel()\n'))
            + 'lab.wait_until(lambda: late_odds.number > 32767)\n',
        ),
        Style('own process, started here', started_by_subprocess(in_process(_LATE))),
        Style(
            'own process',
            in_process(_LATE),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'no limit',
            changed(_LATE, (_GUARD, '')),
            'The field data holds whole numbers from one limit to the other',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'no limit, checked late',
            changed(_LATE, (_GUARD, '')) + 'lab.wait_until(lambda: late_odds.number > 32767)\n',
            'The field data holds whole numbers from one limit to the other',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'held at the limit',
            changed(_LATE, ('self.number = 1\n', 'self.number = 32767\n')),
            'The number is held at 32767',
        ),
        Wrong(
            'goes below zero',
            changed(_LATE, ('self.number = 1\n', 'self.number -= 65536\n')),
            '-32767 is what 16 bits make of 32769',
        ),
        Wrong(
            'remainder of 32767',
            changed(_LATE, (_GUARD, '        self.number %= 32767\n')),
            'The remainder of 32767 divided by 32767 is 0',
        ),
        Wrong(
            'starts over too early',
            changed(_LATE, ('> 32767', '> 32760')),
            'The count starts over too early',
        ),
        Wrong(
            'stops too early',
            changed(
                _LATE,
                ('> 32767', '> 32760'),
                ('            self.number = 1\n', '            self.timer.cancel()\n'),
            ),
            'The count ends before it.',
        ),
        Wrong(
            'first not used',
            changed(_LATE, ('self.number = first', 'self.number = 1')),
            'The count does not begin with the number that LateOdds',
        ),
        Wrong(
            'goes on with 0',
            changed(_LATE, ('self.number = 1\n', 'self.number = 0\n')),
            'The count goes on with 0, which is even',
        ),
        Wrong(
            'a quarter too fast',
            changed(_LATE, ('create_timer(0.1,', 'create_timer(0.08,')),
            '1.25 times too fast',
        ),
        Wrong(
            'too slow, and over when the check comes',
            changed(
                _LATE,
                ('create_timer(0.1,', 'create_timer(0.125,'),
                ('            self.number = 1\n', '            self.timer.cancel()\n'),
            )
            + 'lab.wait_until(lambda: late_odds.number > 32767)\n',
            'times too slow',
        ),
        Wrong(
            'rate for period',
            changed(_LATE, ('create_timer(0.1,', 'create_timer(10,')),
            'A rate in Hz and a period in seconds were mixed up',
        ),
        Wrong(
            'adds before it publishes',
            changed(
                _LATE,
                (
                    '        self.publisher.publish(Int16(data=self.number))\n'
                    '        self.number += 2\n',
                    '        self.number += 2\n',
                ),
                ('self.number = 1\n', 'self.number = 1\n        self.publisher.publish(M)\n'),
                ('publish(M)', 'publish(Int16(data=self.number))'),
            ),
            'The count does not begin with the number that LateOdds',
        ),
        Wrong(
            'starts over, and then stops',
            changed(
                _LATE,
                (
                    '            self.number = 1\n',
                    '            self.number = 1\n        if self.number == 9:\n'
                    '            self.timer.cancel()\n',
                ),
            ),
            'The count starts over, and then it stops.',
        ),
        Wrong(
            'starts over with 3',
            changed(_LATE, ('self.number = 1\n', 'self.number = 3\n')),
            'The count goes on with another number than 1.',
        ),
        Wrong(
            'not spun',
            changed(_LATE, ('lab.spin(LateOdds(first=32751))', 'LateOdds(first=32751)')),
            'Hand the node over: lab.spin(node)',
        ),
        Wrong(
            'goes below zero, in a process of its own',
            changed(in_process(_LATE), ('self.number = 1\n', 'self.number -= 65536\n')),
            'The count should not go below zero.',
            process=True,
        ),
    ],
    records=[TOPIC],
)
