"""Exercise: notice that something does not come any more."""

from __future__ import annotations

import random
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, NoReturn

from labkit.exercises import (
    Clause,
    Exercise,
    Fail,
    Probe,
    Stage,
    common_mistakes,
    expect,
    words_of,
)
from labkit.exercises.clauses import Subscribes, Words
from labkit.exercises.figures import figure
from labkit.exercises.judging import naming

if TYPE_CHECKING:
    from labkit.exercises.messages_heard import Watch

__all__ = ['exercise']

WORDS = words_of(__file__)

EMPTY, STRING = 'std_msgs/msg/Empty', 'std_msgs/msg/String'
HEART, ALARM = '/heartbeat', '/alarm'
# What is promised of the heart, and what is asked for, s. It may be so much less.
OFFERED_SEC = 0.2
SILENCE_SEC, EARLY_SEC = 0.5, 0.1
WITHIN_SEC = 2.0
# The heart of the check beats so often, s, and so often in a row.
PERIOD_SEC = 0.05
BEATS, FEW_BEATS = 16, 7
# What comes so long after the first beat may be of the silence before, s.
GRACE_SEC = 0.25
# The heart itself may stumble on a busy machine, and a watchdog of another process hear late what
# was sent in time: then it beats anew, so many times at most.
ATTEMPTS = 4
READY_SEC = 4.0
# It beats and stops so often, at least and at most; the first rounds are long ones.
ROUNDS, LONG_ROUNDS = (5, 7), 2

NOISE = WORDS.mistake('watchdog/noise')
USED_UP = WORDS.mistake('watchdog/used-up')
NOT_TOLD = WORDS.mistake('watchdog/not-told')
HASTE = WORDS.mistake('watchdog/haste')

ALL_CLEAR = WORDS.mistake('watchdog/all-clear')

_HEARS = Subscribes(HEART, EMPTY)
_BARKS = Words(WORDS.clause('barks'))
_IN_TIME = Words(WORDS.of(within=figure(WITHIN_SEC)).clause('in-time'))
_RESTS = Words(WORDS.clause('rests'))
_AGAIN = Words(WORDS.clause('again'))
CLAUSES = (_HEARS, _RESTS, _BARKS, _IN_TIME, _AGAIN)


class _Heart:
    """A heart that the check lets beat, in real time: a deadline knows no other.

    Args:
        probe: The probe of the check.
        alarms: The messages on the topic of the alarm.
    """

    def __init__(self, probe: Probe, alarms: Watch) -> None:
        from rclpy.duration import Duration
        from rclpy.qos import QoSProfile

        from labkit.exercises.messages_heard import build

        self._probe, self._alarms = probe, alarms
        self._beat = build(EMPTY, {})
        profile = QoSProfile(  # type: ignore[no-untyped-call]
            depth=10, deadline=Duration(seconds=OFFERED_SEC)
        )
        self._publisher = probe.node.create_publisher(type(self._beat), HEART, profile)
        probe.wait(self._publisher.get_subscription_count, READY_SEC)
        self.last = 0.0

    def beat(self, attempts: int, beats: int = BEATS) -> tuple[list[float], bool]:
        """Beat for a while.

        Args:
            attempts: How often it beats anew if there was an alarm.
            beats: How often it beats in a row.

        Returns:
            The moments of alarms meanwhile, those of a steady heart; and whether there was one
            at the first beat.
        """
        from labkit.background.runtime import runtime

        at_first = False
        for attempt in range(ATTEMPTS):
            start = self.last = time.time()
            gap = begun = 0.0
            for _ in range(beats):
                began = time.time()
                self._publisher.publish(self._beat)
                # The longest that it can have been: it is held up before it publishes, or after.
                gap, self.last = max(gap, time.time() - self.last), began
                if not begun:
                    # On a busy machine, too, an alarm at the first beat comes before this ends.
                    runtime.executor.settle(READY_SEC)
                    begun = time.time()
                self._probe.wait(lambda: False, PERIOD_SEC)
            alarms = [at for at in self._heard() if start < at < self.last]
            later = [at for at in alarms if at > max(start + GRACE_SEC, begun)]
            stalled = begun - start > SILENCE_SEC / 2  # then the alarm may be a right one
            at_first = at_first or (not attempt and not stalled and len(alarms) > len(later))
            if not later:
                return [], at_first
            attempts -= gap < SILENCE_SEC / 2
            if attempts <= 0:
                return later, at_first
        return [], at_first

    def rest(self) -> float | None:
        """Be silent until there is an alarm; return how long that took, s, None if none came."""

        def later() -> list[float]:
            return [at for at in self._heard() if at > self.last]

        self._probe.wait(later, self.last + WITHIN_SEC + GRACE_SEC - time.time())
        return next((at - self.last for at in later() if at <= self.last + WITHIN_SEC), None)

    def _heard(self) -> list[float]:
        return [sample.stamp for sample in self._alarms.samples]


class _AHeart(Stage[str]):
    """A heart that the check lets beat and stop, several times."""

    @contextmanager
    def scenes(self, probe: Probe, clauses: Sequence[Clause[str]]) -> Iterator[Sequence[str]]:
        """Look at the alarms."""
        yield [_judge(probe)]

    def tell(self, seen: Sequence[str]) -> str:
        """Say what was seen."""
        return seen[0]


def _judge(probe: Probe) -> str:
    with naming(_HEARS):
        hears = expect.subscription(probe, HEART, deadline_sec=OFFERED_SEC)
        expect.spun(probe, hears)
    with naming(_BARKS):
        source = expect.publisher(probe, ALARM, by=hears.node)
    attempts = 1 if probe.in_this_process(source) else ATTEMPTS
    alarms = probe.watch(ALARM, STRING)
    heart = _Heart(probe, alarms)
    delays, again = [], []
    for number in range(random.randint(*ROUNDS)):
        with naming(_RESTS):
            beats = BEATS if number < LONG_ROUNDS else FEW_BEATS
            later, at_first = heart.beat(attempts, beats)
            _refuse_noise(later)
            again.append(at_first)
        delay = heart.rest()
        if delay is None:
            with naming(_AGAIN if number else _IN_TIME):
                _refuse_silence(number)
        if delay < SILENCE_SEC - EARLY_SEC:
            # A timer that takes no notice of the heart is early or late, as it happens.
            with naming(_RESTS):
                _refuse_noise(heart.beat(attempts)[0])
            with naming(_BARKS):
                raise Fail(
                    f'an alarm when {SILENCE_SEC} s have passed without a heartbeat',
                    f'one {delay:.2f} s after the last heartbeat',
                    HASTE,
                )
        delays.append(delay)
    with naming(_BARKS):
        _refuse_empty(alarms)
    # An alarm may have been on its way when the heart began anew, but not each time.
    if attempts == 1 and all(again[1:]):
        with naming(_RESTS):
            raise Fail(
                f'nothing on {ALARM} while heartbeats come',
                f'a message on {ALARM} each time that the heart begins to beat again',
                ALL_CLEAR,
            )
    return f'{hears.node} noticed each of {len(delays)} silences, and kept quiet in between.'


def _refuse_empty(alarms: Watch) -> None:
    if not all(text.strip() for text in alarms.values('data')):
        raise Fail(
            f'a text in each message on {ALARM}',
            f'data = {expect.show(alarms.values("data"))}',
            common_mistakes.NOT_SET.of(field='data'),
        )


def _refuse_noise(alarms: list[float]) -> None:
    if alarms:
        raise Fail(
            f'nothing on {ALARM} while a heartbeat comes every {PERIOD_SEC} s',
            f'{len(alarms)} message{"s" * (len(alarms) > 1)} on {ALARM} meanwhile',
            NOISE,
        )


def _refuse_silence(number: int) -> NoReturn:
    expect.hanging()
    if number:
        raise Fail(
            'an alarm each time that the heart stops',
            f'one when it stopped before, {number} in all, and none this time',
            USED_UP,
        )
    raise Fail(
        f'a message on {ALARM} within {figure(WITHIN_SEC)} s after the last heartbeat',
        f'nothing within {figure(WITHIN_SEC)} s',
        NOT_TOLD,
    )


exercise = Exercise(
    words=WORDS,
    publishes={ALARM: STRING},
    clauses=CLAUSES,
    stage=_AHeart(),
)
