"""Exercise: stop, or start over, before a number does not fit any more."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from statistics import median
from typing import NoReturn

from labkit.exercises import (
    Exercise,
    Fail,
    Outcome,
    Probe,
    Solution,
    Style,
    Watch,
    Wrong,
    changed,
    expect,
)
from labkit.exercises.watch import Sample
from labkit.lessons._script import in_process

__all__ = ['stay_within']

INT16 = 'std_msgs/msg/Int16'
TOPIC = '/late_odds'
PERIOD_SEC = 0.1
FIRST = 32751
LARGEST = 32767
# So many messages show what comes after the largest number.
ENOUGH = (LARGEST - FIRST) // 2 + 4
# Silence of this length is an end.
QUIET_SEC = 1.2

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


def _judge_stay_within(probe: Probe) -> str:
    recorded = probe.recorded[TOPIC]
    if not recorded:
        source = expect.publisher(probe, TOPIC)
        expect.messages(probe, source, count=1)
    run = _wait_for_end(probe, recorded)
    expect.alone(probe, TOPIC)
    values = [sample.message.data for sample in run]
    _expect_rate(run)
    if run[0].number == 1:
        expect.that(
            values[0] == FIRST,
            expected=f'{FIRST} as the first number on {TOPIC}',
            seen=expect.show(values),
            why=f'The count does not begin with the number that LateOdds(first={FIRST}) gets.',
            todo='Keep it in __init__: self.number = first',
        )
    # Who stops or starts over after the last number but one is within the limit, too.
    for end in (LARGEST, LARGEST - 2):
        if values == [_expected(sample.number, end) for sample in run]:
            break
    else:
        _refuse(values, [_expected(sample.number, LARGEST) for sample in run])
    if run[-1].number > _position(LARGEST):
        return f'After {end} the count starts over: {expect.show(values[-5:])}.'
    expect.that(
        values[-1] >= LARGEST - 2,
        expected=f'odd numbers up to {LARGEST}',
        seen=f'{expect.show(values[-4:])}, then none for {QUIET_SEC} s',
        why=f'{LARGEST} is the largest number that fits. The count ends before it.',
        todo=f'Compare with {LARGEST}: if self.number > {LARGEST}',
    )
    return f'After {values[-1]} nothing more is published.'


def _wait_for_end(probe: Probe, recorded: Watch) -> list[Sample]:
    """Return the messages of the last run, when it is known how the count ends."""

    def more_than(count: int) -> bool:
        recorded.pump()
        return len(recorded) > count

    while len(recorded.last_run()) < ENOUGH:
        # A callback that fails from the limit on is noticed while this waits.
        if not probe.wait(partial(more_than, len(recorded)), QUIET_SEC):
            break
    return recorded.last_run()


def _position(value: int) -> int:
    """Return which message says `value`, before the count starts over."""
    return (value - FIRST) // 2 + 1


def _expected(number: int, end: int) -> int:
    """Return what message number `number` says, if the count starts over after `end`."""
    value = FIRST + 2 * (number - 1)
    return value if value <= end else 1 + (value - end - 2) % (end + 1)


def _expect_rate(run: Sequence[Sample]) -> None:
    gaps = [later.stamp - earlier.stamp for earlier, later in pairwise(run)]
    expect.that(
        not gaps or abs(median(gaps) / PERIOD_SEC - 1.0) < 0.3,
        expected=f'a message every {PERIOD_SEC} s (10 Hz) on {TOPIC}',
        seen=f'a message every {median(gaps or [0.0]):.3g} s',
        why='The rate is set by the period of the timer.',
        todo=f'The first argument of create_timer() is the period in seconds: {PERIOD_SEC}',
    )


def _refuse(values: Sequence[int], wanted: Sequence[int]) -> NoReturn:
    """Raise Fail with the reason why the numbers go on otherwise."""
    place = next(i for i, pair in enumerate(zip(values, wanted, strict=True)) if len({*pair}) > 1)
    seen, before = values[place], values[max(0, place - 1)]
    why = 'The count goes on with another number than 1.'
    if place and seen == before:
        why = f'The number is held at {seen}, and published again and again.'
    elif seen < 0:
        why = f'{seen} is what 16 bits make of {seen + 65536}. The count should not go below zero.'
    elif seen == 0 and before == LARGEST - 2:
        why = f'The remainder of {LARGEST} divided by {LARGEST} is 0, and 0 is even.'
    elif seen % 2 == 0:
        why = f'The count goes on with {seen}, which is even; adding 2 keeps it even.'
    elif place and before + 2 <= LARGEST:
        why = f'The count starts over too early: {before + 2} still fits.'
    raise Fail(
        f'..., {LARGEST - 2}, {LARGEST}, and then 1, 3, ... or nothing more',
        f'..., {expect.show(values[max(0, place - 3) : place + 3])}',
        why=why,
        todo=f'After adding 2: if self.number > {LARGEST}, set self.number = 1.',
    )


stay_within = Exercise(
    name='stay_within',
    task=f'Publish odd numbers on {TOPIC}, ten a second, from {FIRST} on. After {LARGEST} stop, '
    'or start over with 1.',
    publishes={TOPIC: INT16},
    judge=_judge_stay_within,
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
    ],
    records=[TOPIC],
)
