"""Exercise: stop, or start over, before a number does not fit any more."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NoReturn

from labkit.exercises import (
    Exercise,
    Fail,
    Outcome,
    Probe,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
)
from labkit.exercises.clauses import Clause, Evidence, Messages, Publishes, Stream
from labkit.exercises.expect.timing import TOLERANCE
from labkit.exercises.watch import Sample
from labkit.lessons._script import in_process, started_by_subprocess

__all__ = ['stay_within']

INT16 = 'std_msgs/msg/Int16'
TOPIC = '/late_odds'
FIRST = 32751
LARGEST = 32767
# So many messages show what comes after the largest number.
ENOUGH = (LARGEST - FIRST) // 2 + 4
# Silence of this length is an end, s of real time.
QUIET_SEC = 1.2
# So many messages tell their rate exactly where time is virtual.
MIN_EXACT = 4

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


@dataclass(frozen=True)
class _Run(Publishes):
    """A run of messages that began after the setup cell, and may be over when the check comes.

    Its rate is exact where it goes on in virtual time. What came before has real stamps.
    """

    ends: bool = True

    def find(self, evidence: Evidence) -> None:
        """Look for the publisher, or for what it has published."""
        probe = evidence.probe
        if probe.publishers(TOPIC) or not probe.recorded[TOPIC]:
            super().find(evidence)

    def judge(self, evidence: Evidence) -> str:
        """Judge the rate, and give the whole run to the other clauses."""
        lived = evidence.life.on(TOPIC)
        follows = self._follows(lived)
        run = _whole_run(evidence.probe, wait=not follows)
        if not run:
            expect.messages(evidence.probe, evidence.publisher(TOPIC), count=1)
            run = _whole_run(evidence.probe, wait=True)
        evidence.streams[TOPIC, ''] = Stream(TOPIC, tuple(run), follows, evidence.life.seconds)
        trouble = (
            self._trouble(lived, evidence.life) if follows else self._real_trouble(run, lived)
        )
        if trouble is not None:
            self._refuse(trouble)
        return ''

    def _follows(self, lived: Sequence[Sample]) -> bool:
        """Tell whether messages came in virtual time, and not in real time meanwhile.

        Half a minute takes less than a second, so what comes in real time is far too slow.
        """
        gaps = [later.at - earlier.at for earlier, later in pairwise(lived)]
        if len(gaps) < 2:
            return False
        even = max(gaps) - min(gaps) < 1e-6 < min(gaps)
        return even or (len(lived) >= MIN_EXACT and statistics.median(gaps) < 2 * self.period)

    def _real_trouble(
        self, run: Sequence[Sample], lived: Sequence[Sample]
    ) -> tuple[str, str] | None:
        """Judge by the stamps of the messages; time may have flown for those in the middle."""
        first, last = (lived[0].number, lived[-1].number) if lived else (0, 0)
        parts = (
            run,
            [sample for sample in run if not lived or sample.number < first],
            [sample for sample in run if lived and sample.number > last],
        )
        gaps = [_gaps(part) for part in parts if len(part) > 2]
        if not gaps or any(self._fits(part) for part in gaps):
            return None
        longest = max(gaps, key=len)
        return self._off(1 / max(statistics.median(longest), 1e-4))

    def _fits(self, gaps: Sequence[float]) -> bool:
        """Tell whether gaps in real time are those of the rate, see `timing.TOLERANCE`."""
        quick = sorted(gaps)[len(gaps) // 4]
        usual = (quick, statistics.median(gaps), statistics.mean(gaps))
        near = any(abs(gap / self.period - 1.0) <= TOLERANCE for gap in usual)
        return near and quick > 0.3 * self.period


class _AfterTheLimit(Clause):
    """What comes after the last number that fits."""

    text = (
        'after that either nothing more comes, or 1, 3, 5, ... from the beginning; no callback '
        'fails'
    )

    def judge(self, evidence: Evidence) -> str:
        """Judge the numbers from the limit on."""
        stream = evidence.streams[TOPIC, '']
        run, values = stream.samples, stream.values('data')
        # Who stops or starts over after the last number but one is within the limit, too.
        for end in (LARGEST, LARGEST - 2):
            if values == [_expected(sample.number, end) for sample in run]:
                break
        else:
            _refuse(values, [_expected(sample.number, LARGEST) for sample in run])
        if run[-1].number <= _position(LARGEST):
            return f'After {values[-1]} nothing more is published.'
        lived = evidence.life.on(TOPIC)
        if stream.exact and evidence.life.seconds - lived[-1].at > 1.0 + evidence.life.rest:
            raise Fail(
                '1, 3, 5, ... after the limit, ten times a second, or nothing',
                f'..., {expect.show(values[-4:])}, and then nothing more',
                why='The count starts over, and then it stops.',
                todo='Stop at the limit, or go on without end.',
            )
        return f'After {end} the count starts over: {expect.show(values[-5:])}.'


def _up_to_the_limit(stream: Stream) -> str:
    """Judge the numbers that come first."""
    values = stream.values('data')
    before = [s for s in stream.samples if s.number < _position(LARGEST)]
    for sample in before:
        wanted, seen = _expected(sample.number, LARGEST), sample.message.data
        if seen == wanted:
            continue
        expect.that(
            sample.number > 1,
            expected=f'{FIRST} as the first number on {TOPIC}',
            seen=expect.show(values),
            why=f'The count does not begin with the number that LateOdds(first={FIRST}) gets.',
            todo='Keep it in __init__, self.number = first, and publish before you add 2.',
        )
        _refuse(values, [_expected(s.number, LARGEST) for s in stream.samples])
    expect.that(
        stream.samples[-1].number >= _position(LARGEST - 2),
        expected=f'odd numbers up to {LARGEST}',
        seen=f'{expect.show(values[-4:])}, and then none',
        why=f'{LARGEST} is the largest number that fits. The count ends before it.',
        todo=f'Compare with {LARGEST}: if self.number > {LARGEST}',
    )
    return ''


def _whole_run(probe: Probe, *, wait: bool) -> list[Sample]:
    """Return the messages of the last run; wait until it is known how it ends, if asked for."""
    recorded = probe.recorded[TOPIC]

    def is_over() -> bool:
        recorded.pump()
        quiet = time.monotonic() - recorded.last_arrival > QUIET_SEC
        return quiet or len(recorded.last_run()) >= ENOUGH

    if wait and len(recorded):
        # A callback that fails from the limit on is noticed while this waits.
        probe.wait(is_over)
    recorded.pump()
    return recorded.last_run()


def _gaps(samples: Sequence[Sample]) -> list[float]:
    return [later.stamp - earlier.stamp for earlier, later in pairwise(samples)]


def _position(value: int) -> int:
    """Return which message says `value`, before the count starts over."""
    return (value - FIRST) // 2 + 1


def _expected(number: int, end: int) -> int:
    """Return what message number `number` says, if the count starts over after `end`."""
    value = FIRST + 2 * (number - 1)
    return value if value <= end else 1 + (value - end - 2) % (end + 1)


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
    clauses=(
        _Run(TOPIC, 10.0, INT16),
        Messages(
            TOPIC,
            f'the numbers are {FIRST}, {FIRST + 2}, {FIRST + 4}, ..., {LARGEST}, one a message; '
            f'{LARGEST - 2} as the last one is right, too',
            _up_to_the_limit,
        ),
        _AfterTheLimit(),
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
