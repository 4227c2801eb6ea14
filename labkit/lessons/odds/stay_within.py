"""Exercise: stop, or start over, before a number does not fit any more."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from labkit.exercises import Exercise, Fail, Mistake, Probe, expect, words_of
from labkit.exercises.clauses import (
    Asked,
    Evidence,
    Messages,
    Publishes,
    Stream,
)
from labkit.exercises.expect.timing import TOLERANCE
from labkit.exercises.messages_heard import Lived, Sample

__all__ = ['exercise']

WORDS = words_of(__file__)

TOPIC, INT16 = '/late_odds', 'std_msgs/msg/Int16'
FIRST, LARGEST = 32751, 32767
# So many messages show what comes after the largest number.
ENOUGH = (LARGEST - FIRST) // 2 + 4
# Silence of this length is an end, s of real time.
QUIET_SEC = 1.2
# So many messages tell their rate exactly where time is virtual.
MIN_EXACT = 4

HELD = WORDS.mistake('stay-within/held')
BELOW_ZERO = WORDS.mistake('stay-within/below-zero')
REMAINDER = WORDS.mistake('stay-within/remainder-of-32767')
EVEN = WORDS.mistake('stay-within/even')
TOO_EARLY = WORDS.mistake('stay-within/too-early')
ANOTHER_START = WORDS.mistake('stay-within/another-start')
FIRST_NOT_USED = WORDS.mistake('stay-within/first-not-used')
ENDS_EARLY = WORDS.mistake('stay-within/ends-early')
STOPS_LATER = WORDS.mistake('stay-within/stops-later')


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
        follows = self._is_virtual(lived)
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

    def _is_virtual(self, lived: Sequence[Lived]) -> bool:
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
    ) -> tuple[str, Mistake] | None:
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


def _after_the_limit(evidence: Evidence) -> str:
    """Judge the numbers from the limit on."""
    stream = evidence.streams[TOPIC, '']
    run, values = stream.samples, stream.values('data')
    # A count that stops or starts over after the last number but one is within it, too.
    for end in (LARGEST, LARGEST - 2):
        if values == [_expected(sample.number, end) for sample in run]:
            break
    else:
        raise _deviation(run)
    if run[-1].number <= _position(LARGEST):
        return f'After {values[-1]} nothing more is published.'
    lived = evidence.life.on(TOPIC)
    if stream.exact and evidence.life.seconds - lived[-1].at > 1.0 + evidence.life.step:
        raise Fail(
            f'{_again()} after the limit, ten times a second, or nothing',
            f'..., {expect.show(values[-4:])}, and then nothing more',
            STOPS_LATER,
        )
    return f'After {end} the count starts over: {expect.show(values[-5:])}.'


def _up_to_the_limit(stream: Stream) -> None:
    """Judge the numbers that come first."""
    run, values = stream.samples, stream.values('data')
    before = [sample for sample in run if sample.number < _position(LARGEST)]
    wrong = [s for s in before if s.message.data != _expected(s.number, LARGEST)]
    if wrong and wrong[0].number <= 1:
        raise Fail(f'{FIRST} as the first number on {TOPIC}', expect.show(values), FIRST_NOT_USED)
    if wrong:
        raise _deviation(run)
    if run[-1].number < _position(LARGEST - 2):
        raise Fail(
            f'odd numbers up to {LARGEST}',
            f'{expect.show(values[-4:])}, and then none',
            ENDS_EARLY,
        )


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


def _again() -> str:
    after = [_expected(_position(LARGEST) + number, LARGEST) for number in (1, 2, 3)]
    return ', '.join([*map(str, after), '...'])


def _deviation(run: Sequence[Sample]) -> Fail:
    """Return what to say of numbers that go on otherwise than up to the limit and over."""
    values = [sample.message.data for sample in run]
    wanted = [_expected(sample.number, LARGEST) for sample in run]
    place = next(i for i, pair in enumerate(zip(values, wanted, strict=True)) if len({*pair}) > 1)
    seen, before = values[place], values[max(0, place - 1)]
    mistake = ANOTHER_START
    if place and seen == before:
        mistake = HELD
    elif seen < 0:
        mistake = BELOW_ZERO
    elif seen == 0 and before == LARGEST - 2:
        mistake = REMAINDER
    elif seen % 2 == 0:
        mistake = EVEN
    elif place and before + 2 <= LARGEST:
        mistake = TOO_EARLY
    return Fail(
        f'..., {LARGEST - 2}, {LARGEST}, and then 1, 3, ... or nothing more',
        f'..., {expect.show(values[max(0, place - 3) : place + 3])}',
        mistake.of(seen=seen, large=seen + 65536, next=before + 2),
    )


exercise = Exercise(
    words=WORDS,
    clauses=(
        _Run(TOPIC, 10.0, INT16),
        Messages(
            TOPIC,
            WORDS.of(
                first=FIRST,
                second=FIRST + 2,
                third=FIRST + 4,
                largest=LARGEST,
                last_but_one=LARGEST - 2,
            ).clause('messages'),
            _up_to_the_limit,
        ),
        Asked(
            WORDS.of(again=_again()).clause('after-the-limit'),
            _after_the_limit,
        ),
    ),
    records=[TOPIC],
)
