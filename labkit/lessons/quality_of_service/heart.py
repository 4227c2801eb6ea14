"""The heart that the check of the watchdog lets beat, in real time, and what it asks for."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, NoReturn

from labkit.exercises import Fail, Probe, expect
from labkit.exercises.clauses import Clause, Subscribes
from labkit.exercises.clauses.base import naming

if TYPE_CHECKING:
    from labkit.exercises.watch import Watch

__all__ = ['ALARM', 'CLAUSES', 'EMPTY', 'HEART', 'STRING', 'judge']

EMPTY, STRING = 'std_msgs/msg/Empty', 'std_msgs/msg/String'
HEART, ALARM = '/heartbeat', '/alarm'
# What is promised of the heart, and what is asked for, s.
OFFERED_SEC = 0.2
SILENCE_SEC = 0.5
WITHIN_SEC = 2.0
# The heart of the check beats so often, s, and so often in a row.
PERIOD_SEC = 0.05
BEATS = 16
# An alarm of the silence before may still be on its way so long, s.
GRACE_SEC = 0.25
# On a busy machine the heart itself may stumble: then it beats anew, so many times at most.
ATTEMPTS = 4
# A beat may be taken a little later than it was sent, s.
EARLY_SEC = 0.1
# On a busy machine an alarm may take longer than it should, s.
PATIENCE_SEC = 4.0
ROUNDS = 2


@dataclass(frozen=True)
class _Words(Clause):
    """A clause that the judge of this exercise looks at, as it beats."""

    words: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words


_HEARS = Subscribes(HEART, EMPTY)
_BARKS = _Words(
    f'when no heartbeat has come for {SILENCE_SEC} s, publish a text on `{ALARM}` (`{STRING}`), '
    f'within {WITHIN_SEC:g} s'
)
_RESTS = _Words(f'publish nothing on `{ALARM}` while heartbeats come')
_AGAIN = _Words('do so each time that the heart stops')
CLAUSES = (_HEARS, _RESTS, _BARKS, _AGAIN)


class _Heart:
    """A heart that the check lets beat, in real time: a deadline knows no other.

    Args:
        probe: The probe of the check.
        alarms: The messages on the topic of the alarm.
    """

    def __init__(self, probe: Probe, alarms: Watch) -> None:
        from rclpy.duration import Duration
        from rclpy.qos import QoSProfile

        from labkit.exercises.watch import build

        self._probe, self._alarms = probe, alarms
        self._beat = build(EMPTY, {})
        profile = QoSProfile(  # type: ignore[no-untyped-call]
            depth=10, deadline=Duration(seconds=OFFERED_SEC)
        )
        self._publisher = probe.node.create_publisher(type(self._beat), HEART, profile)
        probe.wait(self._publisher.get_subscription_count, PATIENCE_SEC)
        self.last = 0.0

    def beat(self) -> list[float]:
        """Beat for a while; return the moments of alarms meanwhile, those of a steady heart."""
        longest = []
        for _ in range(ATTEMPTS):
            start = time.time()
            gap, self.last = 0.0, start
            for _ in range(BEATS):
                gap = max(gap, time.time() - self.last)
                self.last = time.time()
                self._publisher.publish(self._beat)
                self._probe.wait(lambda: False, PERIOD_SEC)
            alarms = [at for at in self._heard() if start + GRACE_SEC < at < self.last]
            if not alarms:
                return []
            longest.append(gap)
        # A watchdog on a busy machine may have heard late what was sent in time.
        return alarms if min(longest) < SILENCE_SEC / 2 else []

    def rest(self) -> float | None:
        """Be silent until there is an alarm; return how long that took, s, None if none came."""

        def later() -> list[float]:
            return [at for at in self._heard() if at > self.last]

        self._probe.wait(later, PATIENCE_SEC)
        return later()[0] - self.last if later() else None

    def _heard(self) -> list[float]:
        return [sample.stamp for sample in self._alarms.samples]


def judge(probe: Probe) -> str:
    """Let a heart beat and stop, twice, and look at the alarms.

    Raises:
        NotAttempted: Nothing of the learner's shows an attempt.
        Fail: A clause is not fulfilled; the exception names it.
    """
    with naming(_HEARS):
        hears = expect.subscription(probe, HEART, deadline_sec=OFFERED_SEC)
        expect.spun(probe, hears)
    with naming(_BARKS):
        expect.publisher(probe, ALARM, by=hears.node)
    heart = _Heart(probe, probe.watch(ALARM, STRING))
    delays = []
    for number in range(ROUNDS):
        with naming(_RESTS):
            _refuse_noise(heart.beat())
        with naming(_AGAIN if number else _BARKS):
            delay = heart.rest()
            if delay is None:
                _refuse_silence(probe, number)
            if delay < SILENCE_SEC - EARLY_SEC:
                # A timer that takes no notice of the heart is early or late, as it happens.
                with naming(_RESTS):
                    _refuse_noise(heart.beat())
                _refuse_haste(delay)
            delays.append(delay)
    return f'{hears.node} noticed each of {len(delays)} silences, and kept quiet in between.'


def _refuse_noise(alarms: list[float]) -> None:
    if alarms:
        raise Fail(
            f'nothing on {ALARM} while a heartbeat comes every {PERIOD_SEC} s',
            f'{len(alarms)} message{"s" * (len(alarms) > 1)} on {ALARM} meanwhile',
            why='The alarm does not depend on whether heartbeats come: a timer or the callback of '
            'the heartbeat publishes it, or the time is too short.',
            todo=f'Publish when {SILENCE_SEC} s have passed without a heartbeat, as the event of '
            'the deadline tells.',
        )


def _refuse_silence(probe: Probe, number: int) -> NoReturn:
    expect.hanging()
    if number:
        raise Fail(
            'an alarm each time that the heart stops',
            'an alarm at the first time, and none at the second one',
            why='Something is used up by the first alarm: a flag that is never set back, or an '
            'event that is looked at once.',
            todo='Let each missed deadline publish.',
        )
    raise Fail(
        f'a message on {ALARM} within {WITHIN_SEC:g} s after the last heartbeat',
        f'nothing within {PATIENCE_SEC:g} s',
        why='Nobody is told that heartbeats are missing, or what is told does not publish.',
        todo=f'Give the subscription a profile with deadline=Duration(seconds={SILENCE_SEC}), and '
        'event_callbacks=SubscriptionEventCallbacks(deadline=...), where you publish.',
    )


def _refuse_haste(delay: float) -> NoReturn:
    raise Fail(
        f'an alarm when {SILENCE_SEC} s have passed without a heartbeat',
        f'one {delay:.2f} s after the last heartbeat',
        why='The time is too short: a heart that beats a little late would set it off.',
        todo=f'Take a deadline of {SILENCE_SEC} s: Duration(seconds={SILENCE_SEC}).',
    )
