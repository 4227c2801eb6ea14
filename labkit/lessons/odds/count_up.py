"""Exercise: the odd numbers, one after the other."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from labkit.exercises import Exercise, Fail, Mistake, Probe, Solution, expect
from labkit.exercises.clauses import Messages, Publishes, Stream, often
from labkit.exercises.observation import live
from labkit.exercises.variants import varied

__all__ = ['exercise']

TOPIC, INT16 = '/odds', 'std_msgs/msg/Int16'
# The first number that does not fit into an Int16.
LIMIT = 2**15

_KEEP = (
    'Keep the number in the node (self.number = {first} in __init__), and add {step} each time.'
)
SAME = Mistake(
    'count-up/same',
    'Every message says {number}: the number is not changed between one message and the next.',
    _KEEP,
)
IN_TURN = Mistake(
    'count-up/in-turn',
    'Odd and even numbers come in turn: 1 is added, and not {step}.',
    _KEEP,
    change=[('self.number += 2', 'self.number += 1')],
)
EVEN = Mistake(
    'count-up/even',
    'These are even numbers. 2 more than an even number is even again.',
    'Start with {first}, and add {step} each time.',
    change=[('self.number = 1', 'self.number = 0')],
)
STARTS_OVER = Mistake(
    'count-up/starts-over',
    'The values start over: the number is set anew although the count goes on.',
    _KEEP,
    change=[('self.number += 2', 'self.number = (self.number + 2) % 100')],
)
ANOTHER_STEP = Mistake(
    'count-up/another-step',
    'The step is not {step} each time. Does more than one place change the number?',
    _KEEP,
    change=[('self.number += 2', 'self.number += 2 if self.number < 61 else 4')],
)
ANOTHER_START = Mistake(
    'count-up/another-start',
    'The count does not start with {first}. Is the number changed before it is published for the '
    'first time?',
    'Set the number to {first} in __init__, and publish before you change it.',
    change=[
        ('        self.number += 2\n', ''),
        ('        msg = Int16()', '        self.number += 2\n        msg = Int16()'),
    ],
)


def _judge(stream: Stream, first: int, step: int, words: str) -> str:
    values = stream.values('data')
    gaps = [later - earlier for earlier, later in pairwise(values)]
    told = expect.show(values)
    found = None
    if not all(value % 2 for value in values):
        found = IN_TURN if any(value % 2 for value in values) else EVEN
    elif any(gap != step for gap in gaps):
        found = STARTS_OVER if min(gaps) < 0 else ANOTHER_STEP
    if found is not None and not any(gaps[1:]):
        found = SAME
    start = stream.samples[0]
    # An Int16 holds no more after so many odd numbers: then the count has to start over.
    if found is None and start.number < (LIMIT - first) // step - 383:
        began = values[0] - step * (start.number - 1)
        if start.number and began != first:
            told = f'{values[0]} as message number {start.number}, so the first one said {began}'
            found = ANOTHER_START
    if found is not None:
        raise Fail(
            f'odd numbers on {TOPIC}: {words}',
            f'data = {told} on {TOPIC}',
            found.of(first=first, step=step, number=values[-1]),
        )
    return f'The numbers are {told}.'


def _variant(*, first: int = 1, step: int = 2, hz: float = 5.0) -> Exercise:
    words = f'{first}, {first + step}, {first + 2 * step}, ...'
    period, rate = f'{1 / hz:g}', often(hz).partition(' (')[0]
    return Exercise(
        name='count_up',
        task=f'Publish the odd numbers {words} on {TOPIC} as `Int16`, {rate}.',
        clauses=(
            Publishes(TOPIC, hz, INT16),
            Messages(
                TOPIC,
                f'the odd numbers {words}, one in each message',
                lambda stream: _judge(stream, first, step, words),
            ),
        ),
        hints=[
            'The callback runs again and again. What must outlive one run, so that the next one '
            'can go on from there?',
            'A variable of the callback is gone when the callback returns. An attribute of the '
            f'node stays: self.number = {first} in __init__.',
            'In the callback: msg.data = self.number, publish it, then self.number += '
            f'{step}. The period is {period} s.',
        ],
        answer=Solution(
            __file__,
            'count_up.py',
            'The number lives in the node, so it is still there when the callback runs again. It '
            f'is published first and changed afterwards, so the first message says {first}.',
        ).changed(
            ('self.number = 1', f'self.number = {first}'),
            ('self.number += 2', f'self.number += {step}'),
            ('create_timer(0.2,', f'create_timer({period},'),
        ),
    )


def _guess(probe: Probe) -> dict[str, Any] | None:
    source = expect.publisher(probe, TOPIC)
    samples = live(probe, {TOPIC: INT16}, 5.0, nodes=[source.node]).on(TOPIC)
    if len(samples) < 3:
        return None
    (first, second), gap = samples[:2], samples[2].at - samples[1].at
    step = second.message.data - first.message.data
    return {
        'first': first.message.data - step * (first.number - 1),
        'step': step,
        'hz': round(1 / gap, 3) if gap else 0.0,
    }


# None is another one plus or minus a few steps.
exercise = varied(
    _variant(), _variant, _guess, first=range(15, 2000, 14), step=(4, 6), hz=(1.0, 2.0)
)
