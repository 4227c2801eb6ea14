"""What the check of the exercise stay_within asks for."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NoReturn

from labkit.exercises import (
    Fail,
    Probe,
    expect,
)
from labkit.exercises.clauses import Clause, Evidence, Publishes, Stream
from labkit.exercises.expect.timing import TOLERANCE
from labkit.exercises.watch import Lived, Sample

__all__ = ['FIRST', 'LARGEST', 'TOPIC', 'AfterTheLimit', 'Run', 'up_to_the_limit']

TOPIC = '/late_odds'
FIRST = 32751
LARGEST = 32767
# So many messages show what comes after the largest number.
ENOUGH = (LARGEST - FIRST) // 2 + 4
# Silence of this length is an end, s of real time.
QUIET_SEC = 1.2
# So many messages tell their rate exactly where time is virtual.
MIN_EXACT = 4


@dataclass(frozen=True)
class Run(Publishes):
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

    def _follows(self, lived: Sequence[Lived]) -> bool:
        """Tell whether messages came in virtual time, and not in real time meanwhile.

        Half a minute takes less than a second, so what comes in real time is far too slow.
        """
        gaps = [later.at - earlier.at for earlier, later in pairwise(lived)]
        if len(gaps) < 2:
            return False
        even = max(gaps) - min(gaps) < 1e-6 < min(gaps)
        return even or (len(lived) >= MIN_EXACT and statistics.median(gaps) < 2 * self.period)

    def _real_trouble(
        self, run: Sequence[Sample], lived: Sequence[Lived]
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


class AfterTheLimit(Clause):
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


def up_to_the_limit(stream: Stream) -> str:
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
