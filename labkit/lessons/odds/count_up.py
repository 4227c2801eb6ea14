"""Exercise: the odd numbers, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from labkit.exercises import Exercise, Probe, Solution, Style, Wrong, changed, expect
from labkit.exercises.clauses import Messages, Publishes, Stream, often
from labkit.exercises.life import live
from labkit.exercises.variants import varied
from labkit.lessons._script import in_process, two_copies

__all__ = ['count_up']

INT16 = 'std_msgs/msg/Int16'
# The first number that does not fit into an Int16.
LIMIT = 2**15

_ODDS = """
from rclpy.node import Node
from std_msgs.msg import Int16


class Odds(Node):
    def __init__(self):
        super().__init__('odd_source')
        self.publisher = self.create_publisher(Int16, 'odds', 10)
        self.timer = self.create_timer(0.2, self.on_timer)
        self.number = 1

    def on_timer(self):
        msg = Int16()
        msg.data = self.number
        self.publisher.publish(msg)
        self.number += 2


odds = lab.spin(Odds())
"""


@dataclass(frozen=True)
class _OddNumbers:
    """The rule that the numbers follow."""

    first: int = 1
    step: int = 2

    @property
    def words(self) -> str:
        """The first of them: `'1, 3, 5, ...'`."""
        return f'{self.first}, {self.first + self.step}, {self.first + 2 * self.step}, ...'

    def __call__(self, stream: Stream) -> str:
        first, step = self.first, self.step
        expect.each(
            stream,
            'data',
            lambda value: value % 2 == 1,
            expected=f'odd numbers on /odds: {self.words}',
            why=_why_even(stream.values('data'), step),
            todo=f'Start with {first}, and add {step} each time.',
        )
        expect.steps(
            stream,
            'data',
            step,
            todo=f'Keep the number in the node (self.number = {first} in __init__), and add '
            f'{step} in the callback.',
        )
        # Until so many odd numbers have come that an Int16 holds no more, none starts over.
        if stream.samples[0].number < (LIMIT - first) // step - 383:
            expect.first(
                stream,
                'data',
                first,
                step,
                why=f'The count does not start with {first}. Is the number changed before it is '
                'published for the first time?',
            )
        return f'The numbers are {expect.show(stream.values("data"))}.'


def _why_even(values: Sequence[int], step: int) -> str:
    if len(set(values[1:])) == 1:
        return f'Every message says {values[1]}: the number is not changed after each message.'
    if any(value % 2 for value in values):
        return f'Odd and even numbers come in turn: 1 is added, and not {step}.'
    return 'These are even numbers. 2 more than an even number is even again.'


_USUAL = Exercise(
    name='count_up',
    task='Publish the odd numbers 1, 3, 5, ... on /odds as `Int16`, five a second.',
    publishes={'/odds': INT16},
    clauses=(
        Publishes('/odds', 5.0, INT16),
        Messages('/odds', 'the odd numbers 1, 3, 5, ..., one a message', _OddNumbers()),
    ),
    hints=[
        'The callback runs again and again. What must outlive one run, so that the next one can '
        'go on from there?',
        'A variable of the callback is gone when the callback returns. An attribute of the node '
        'stays: self.number = 1 in __init__.',
        'In the callback: msg.data = self.number, publish it, then self.number += 2. The period '
        'is 0.2 s.',
    ],
    answer=Solution(
        _ODDS,
        'The number lives in the node, so it is still there when the callback runs again. It is '
        'published first and changed afterwards, so the first message says 1.',
    ),
    styles=[
        Style(
            'functions',
            """
import itertools

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('counter')
publisher = node.create_publisher(Int16, '/odds', 10)
numbers = itertools.cycle(range(1, 32767, 2))
node.create_timer(0.2, lambda: publisher.publish(Int16(data=next(numbers))))
lab.spin(node)
""",
        ),
        Style(
            'a loop with a rate, in a thread',
            """
import threading
import time

import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('loop')
publisher = node.create_publisher(Int16, 'odds', 1)


def work(publisher):
    for number in range(1, 2001, 2):
        if not rclpy.ok():
            break
        publisher.publish(Int16(data=number))
        time.sleep(1 / 5)


threading.Thread(target=work, args=[publisher], daemon=True).start()
""",
        ),
        Style(
            'a timer that wakes a thread',
            changed(
                _ODDS,
                ('\nfrom rclpy', '\nimport queue\nimport threading\n\nfrom rclpy'),
                ('self.on_timer)\n', 'lambda: self.ticks.put(1))\n'),
                (
                    'self.number = 1\n',
                    'self.number = 1\n        self.ticks = queue.Queue()\n'
                    '        threading.Thread(target=self.work, daemon=True).start()\n\n'
                    '    def work(self):\n        while self.ticks.get():\n'
                    '            sum(range(100_000))  # it takes its time\n'
                    '            self.on_timer()\n',
                ),
            ),
        ),
        Style(
            'a fast timer, and every fourth call counts',
            """
import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('one')
publisher = node.create_publisher(Int16, 'odds', 10)
calls = 0


def on_timer():
    global calls
    if calls % 4 == 0:
        publisher.publish(Int16(data=calls // 2 + 1))
    calls += 1


node.create_timer(0.05, on_timer)
lab.spin(node)
""",
        ),
        Style(
            'in a namespace, with the full name of the topic',
            changed(
                _ODDS,
                (
                    "super().__init__('odd_source')",
                    "super().__init__('add_one', namespace='sums')",
                ),
                ("'odds', 10", "'/odds', 10"),
            ),
        ),
        Style('own process', in_process(_ODDS), process=True),
    ],
    wrong=[
        Wrong(
            'starts at 0',
            changed(_ODDS, ('self.number = 1', 'self.number = 0')),
            'These are even numbers.',
        ),
        Wrong(
            'adds 1',
            changed(_ODDS, ('self.number += 2', 'self.number += 1')),
            '1 is added, and not 2',
        ),
        Wrong(
            'adds before it publishes',
            changed(
                _ODDS,
                ('        self.number += 2\n', ''),
                ('        msg = Int16()', '        self.number += 2\n        msg = Int16()'),
            ),
            'The count does not start with 1.',
        ),
        Wrong(
            'starts over',
            changed(
                _ODDS,
                ('        self.number = 1\n', ''),
                ('        msg = Int16()', '        self.number = 1\n        msg = Int16()'),
            ),
            'Every message says the same',
        ),
        Wrong(
            '=+ for +=',
            changed(_ODDS, ('self.number += 2', 'self.number =+ 2')),
            'Every message says 2',
            refused='No formatter writes =+ without a space.',
        ),
        Wrong(
            'in the namespace of the node',
            changed(_ODDS, ("'odds', 10", "'~/odds', 10")),
            'it lies in another namespace',
        ),
        Wrong(
            'wrong type',
            changed(_ODDS, ('Int16', 'Int32')),
            'A topic carries one type of message.',
        ),
        Wrong(
            'forgot to publish',
            changed(_ODDS, ('        self.publisher.publish(msg)\n', '')),
            'publish() is not called there',
        ),
        Wrong(
            'off by ten',
            changed(_ODDS, ('create_timer(0.2,', 'create_timer(0.02,')),
            'times too fast',
        ),
        Wrong(
            'two copies running',
            two_copies(_ODDS),
            'Two copies of the node run at once',
            process=True,
        ),
        Wrong(
            'a third too slow',
            changed(_ODDS, ('create_timer(0.2,', 'create_timer(0.3,')),
            '1.5 times too slow',
        ),
        Wrong(
            'three per cent too slow',
            changed(_ODDS, ('create_timer(0.2,', 'create_timer(0.206,')),
            '1.03 times too slow',
        ),
        Wrong(
            'every 5 s',
            changed(_ODDS, ('create_timer(0.2,', 'create_timer(5,')),
            'A rate in Hz and a period in seconds were mixed up',
        ),
        Wrong(
            'ends at 19',
            changed(
                _ODDS,
                (
                    '        self.number += 2\n',
                    '        self.number += 2\n        if self.number > 19:\n'
                    '            self.timer.cancel()\n',
                ),
            ),
            'They stop coming.',
        ),
        Wrong(
            'starts over at 100',
            changed(_ODDS, ('self.number += 2', 'self.number = (self.number + 2) % 100')),
            'The values start over',
        ),
        Wrong(
            'each number twice',
            changed(
                _ODDS,
                (
                    '        self.publisher.publish(msg)\n',
                    '        self.publisher.publish(msg)\n        self.publisher.publish(msg)\n',
                ),
            ),
            'Twice as many messages come as were asked for',
        ),
        Wrong(
            'right first, wrong later',
            changed(
                _ODDS,
                ('self.number += 2', 'self.number += 2 if self.number < 61 else 4'),
            ),
            'The step changes',
        ),
    ],
)


def _variant(*, first: int, step: int, hz: float) -> Exercise:
    numbers = _OddNumbers(first, step)
    period = f'{1 / hz:g}'
    code = changed(
        _ODDS,
        ('self.number = 1', f'self.number = {first}'),
        ('self.number += 2', f'self.number += {step}'),
        ('create_timer(0.2,', f'create_timer({period},'),
    )
    rate = often(hz).partition(' (')[0]
    return replace(
        _USUAL,
        task=f'Publish the odd numbers {numbers.words} on /odds as `Int16`, {rate}.',
        clauses=(
            Publishes('/odds', hz, INT16),
            Messages('/odds', f'the odd numbers {numbers.words}, one a message', numbers),
        ),
        hints=[
            _USUAL.hints[0],
            'A variable of the callback is gone when the callback returns. An attribute of the '
            f'node stays: self.number = {first} in __init__.',
            'In the callback: msg.data = self.number, publish it, then self.number += '
            f'{step}. The period is {period} s.',
        ],
        answer=Solution(code, changed(_USUAL.answer.reason, ('says 1', f'says {first}'))),
        styles=(),
        wrong=(),
    )


def _guess(probe: Probe) -> dict[str, Any] | None:
    source = expect.publisher(probe, '/odds')
    samples = live(probe, {'/odds': INT16}, 5.0, nodes=[source.node]).on('/odds')
    if len(samples) < 3:
        return None
    (first, second), gap = samples[:2], samples[2].at - samples[1].at
    step = second.message.data - first.message.data
    return {
        'first': first.message.data - step * (first.number - 1),
        'step': step,
        'hz': round(1 / gap, 3) if gap else 0.0,
    }


count_up = varied(
    _USUAL,
    _variant,
    _guess,
    # None is another one plus or minus a few steps.
    first=range(15, 2000, 14),
    step=(4, 6),
    hz=(1.0, 2.0),
)
