"""The clauses that the driving tasks of this lesson share."""

from __future__ import annotations

import statistics
from collections.abc import Collection
from dataclasses import dataclass
from functools import partial

from labkit.exercises import Clause, Fail, words_of
from labkit.exercises.clauses import Asked, in_words
from labkit.exercises.clauses.publishing import OFF, TOLERANCE
from labkit.exercises.figures import figure, many
from labkit.exercises.what_is_asked import PUBLISHER, SUBSCRIPTION, Role
from labkit.lessons.turtlebot.drive import STEP_SEC, TWIST, Drive

__all__ = [
    'AT_ONCE',
    'MANY',
    'NAN',
    'PER_SECOND',
    'RATE',
    'RESTS',
    'REST_SEC',
    'SENSIBLE',
    'STOPS',
    'UNASKED',
    'Begins',
    'Hears',
    'look_at_end',
    'look_at_numbers',
    'look_at_rate',
    'look_at_time',
    'short',
]

WORDS = words_of(__file__)

# How soon after the sign the first command has to come, s.
BEGIN_SEC = 0.5
# How far one gap between two commands may be off, as a part of it.
GAP_TOLERANCE = 0.5
# How long the robot may rest, s.
REST_SEC = 1.0
# What no robot of this kind can do, m/s and rad/s; degrees for radians are beyond it.
TOO_FAST, TOO_ROUND = 1.0, 10.0
# Commands a second, in words of a task.
MANY = in_words(1 / STEP_SEC)
PER_SECOND = f'a second ({OFF})'
RATE = f'publish on `/cmd_vel` (`Twist`) {MANY} times {PER_SECOND}'

USED_UP = WORDS.mistake('turtlebot/used-up')
NOT_STARTED = WORDS.mistake('turtlebot/not-started')
UNASKED = WORDS.mistake('turtlebot/unasked')
LATE = WORDS.mistake('turtlebot/late')
AT_ONCE = WORDS.mistake('turtlebot/at-once')
BY_SENSOR = WORDS.mistake('turtlebot/by-sensor')
TWICE = WORDS.mistake('turtlebot/twice')
PERIOD = WORDS.mistake('turtlebot/period')
STOP_AT_ONCE = WORDS.mistake('turtlebot/stop-at-once')
ELSE = WORDS.mistake('turtlebot/something-else')
PAUSES = WORDS.mistake('turtlebot/pauses')

WHEELS = WORDS.mistake('turtlebot/wheels')
IMPOSSIBLE = WORDS.mistake('turtlebot/impossible')
DEGREES = WORDS.mistake('turtlebot/degrees')
NAN = WORDS.mistake('turtlebot/nan')

ENDLESS = WORDS.mistake('turtlebot/endless')
NO_STOP = WORDS.mistake('turtlebot/no-stop')
ON_ITS_WAY = WORDS.mistake('turtlebot/on-its-way')
STILL_TALKS = WORDS.mistake('turtlebot/still-talks')
SLOW = WORDS.mistake('turtlebot/slow')


def short(msg_type: str) -> str:
    """Return the name of a type as it is imported, such as `'Twist'`."""
    return msg_type.rpartition('/')[2]


@dataclass(frozen=True)
class Begins(Clause[Drive]):
    """The node begins each time that a message comes, and only then.

    Attributes:
        topic: The topic of the sign to start.
        msg_type: Name of its type.
    """

    topic: str
    msg_type: str

    @property
    def text(self) -> str:
        """What is asked for."""
        told = WORDS.of(within=BEGIN_SEC, msg_type=short(self.msg_type), topic=self.topic)
        return told.clause('begins')

    @property
    def roles(self) -> dict[Role, str]:
        """The node hears the sign, and publishes commands."""
        return {(SUBSCRIPTION, self.topic): self.msg_type, (PUBLISHER, '/cmd_vel'): TWIST}

    @property
    def listens(self) -> Collection[str]:
        """Where the node commands."""
        return ('/cmd_vel',)

    def find(self, seen: Drive) -> None:
        """Look for such a node."""
        seen.evidence.publisher('/cmd_vel', seen.evidence.subscription(self.topic).node)

    def judge(self, drive: Drive) -> str:
        """Look at the first command."""
        expected = f'a command on /cmd_vel within {BEGIN_SEC} s after a message on {self.topic}'
        if not drive.commands and drive.number:
            raise Fail(
                'a drive each time that a message comes',
                f'drives after {drive.number} of them, and nothing after the next one',
                USED_UP,
            )
        if not drive.commands:
            raise Fail(expected, 'nothing, though the sign to start was given', NOT_STARTED)
        first = drive.commands[0]
        if first.at < drive.sign:
            raise Fail(
                'no command before the sign to start',
                f'{first}, {drive.sign - first.at:.2f} s before it',
                UNASKED,
            )
        if first.at - drive.sign > BEGIN_SEC + drive.margin:
            seconds = first.at - drive.sign
            raise Fail(expected, f'the first one comes after {seconds:.2f} s', LATE)
        return ''


@dataclass(frozen=True)
class Hears(Clause[Drive]):
    """The node that drives subscribes to a sensor of the robot as well.

    Attributes:
        topic: The topic of the sensor.
        msg_type: Name of its type.
        sign: The topic of the sign to start, which tells the node.
    """

    topic: str
    msg_type: str
    sign: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return WORDS.of(topic=self.topic, msg_type=short(self.msg_type)).clause('hears')

    @property
    def roles(self) -> dict[Role, str]:
        """The node subscribes to the topic."""
        return {(SUBSCRIPTION, self.topic): self.msg_type}

    def find(self, seen: Drive) -> None:
        """Look for the subscription."""
        seen.evidence.subscription(self.topic, seen.evidence.subscription(self.sign).node)


def look_at_rate(drive: Drive, pause: float = 0.0, pauses: int = 0) -> None:
    """Raise Fail if commands don't come ten times a second, until the one that says stop.

    Args:
        drive: The drive.
        pause: How long a pause between two of them may be, s; 0 if there may be none.
        pauses: How many pauses there may be.
    """
    gaps, margin = drive.gaps, drive.margin
    if not gaps:
        return
    fail = partial(Fail, f'a command every {STEP_SEC} s (10 Hz), until the drive is over')
    if max(gaps) <= 1e-3:
        raise fail(f'{many(len(drive.commands), "command")} at once', AT_ONCE)
    usual = [gap for gap in gaps if gap <= (1 + GAP_TOLERANCE) * STEP_SEC + margin]
    # Without pauses, as between the sides of a square.
    longest = 1.5 * statistics.median(gaps)
    period = statistics.mean(gap for gap in gaps if gap <= longest)
    # A time that is known to a step tells a rate less exactly when a drive is short.
    seconds = sum(usual)
    tolerance = TOLERANCE + (2 * margin / seconds if seconds else 0.0)
    if abs(period / STEP_SEC - 1) > tolerance:
        seen = f'a command every {figure(period)} s ({figure(1 / period)} Hz)'
        by_sensor, twice = abs(period - 1 / 30) < 0.002, abs(period - STEP_SEC / 2) < 0.002
        raise fail(seen, BY_SENSOR if by_sensor else TWICE if twice else PERIOD)
    soonest = (1 - GAP_TOLERANCE) * STEP_SEC - margin
    few = [gap for gap in gaps if gap < soonest]
    if drive.ending and gaps[-1] < soonest:
        raise fail(
            f'the stop command comes {figure(gaps[-1])} s after the last step', STOP_AT_ONCE
        )
    if few:
        raise fail(f'{figure(min(few))} s from one command to the next, once at least', ELSE)
    rests = [gap for gap in gaps if gap not in usual]
    if len(rests) > pauses or any(gap > pause + margin for gap in rests):
        told = f'the longest one of {figure(max(rests))} s'
        raise fail(f'{many(len(rests), "pause")}, {told}', PAUSES)


def look_at_numbers(drive: Drive) -> None:
    """Raise Fail if a command asks for what a robot can't do."""
    for command in drive.commands:
        fast, round_ = abs(command.v) <= TOO_FAST, abs(command.w) <= TOO_ROUND
        if fast and round_ and not command.others:
            continue
        turning = WHEELS if round_ else NAN if command.w != command.w else DEGREES
        raise Fail(
            f'at most {figure(TOO_FAST)} m/s in linear.x and {figure(TOO_ROUND)} rad/s in '
            'angular.z, and 0.0 in the other numbers',
            f'a command with {command}',
            turning if fast else IMPOSSIBLE,
        )


def look_at_end(drive: Drive, *, may_rest: bool = False, may_pause: bool = False) -> None:
    """Raise Fail if the last command does not say stop, or more follows.

    Args:
        drive: The drive.
        may_rest: Whether the robot may rest on its way, and for a moment at the end.
        may_pause: Whether it may rest on its way only.
    """
    ending, moving = drive.ending, drive.moving
    if not moving:
        return
    expected = 'a last command with all numbers 0.0, and then none'
    if not ending and drive.cut:
        seen = f'the command {moving[-1]}, and more of them, {drive.duration:.0f} s after the sign'
        raise Fail(expected, seen, ENDLESS)
    if not ending:
        raise Fail(expected, f'the last command says {moving[-1]}', NO_STOP)
    rest = next((n for n, command in enumerate(moving, start=1) if command.stops), 0)
    if rest and not (may_rest or may_pause):
        seen = f'command {rest} of {len(moving)} says stop, and then it drives on'
        raise Fail('one command that says stop, at the end', seen, ON_ITS_WAY)
    seconds = ending[-1].at - ending[0].at
    if seconds > REST_SEC + drive.margin if may_rest else len(ending) > 1:
        seen = f'{many(len(ending), "command")} to stop, over {seconds:.1f} s'
        raise Fail(expected, seen, STILL_TALKS)


def look_at_time(drive: Drive, seconds: float) -> None:
    """Raise Fail if a drive takes longer than so many seconds."""
    taken = drive.moving[-1].at - drive.sign if drive.moving else 0.0
    if taken > seconds + drive.margin:
        expected = f'an end of the drive {figure(seconds)} s after the message'
        raise Fail(expected, f'it still moves after {taken:.1f} s', SLOW)


SENSIBLE = Asked(
    WORDS.of(too_fast=figure(TOO_FAST), too_round=figure(TOO_ROUND)).clause('sensible'),
    look_at_numbers,
)
STOPS = Asked(WORDS.clause('stops'), look_at_end)
RESTS = Asked(
    WORDS.of(rest=figure(REST_SEC)).clause('rests'),
    partial(look_at_end, may_rest=True),
)
