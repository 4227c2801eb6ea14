"""Exercise: a Twist from the command line, with fields in fields."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from labkit.exercises import Exercise, Fail, Mistake, NotAttempted, words_of
from labkit.exercises.clauses import Asked, in_words
from labkit.exercises.expect import digits
from labkit.exercises.figures import figure
from labkit.exercises.messages_heard import Sample
from labkit.lessons.command_line.last_command import commanded_rate
from labkit.lessons.command_line.sent import (
    TOLERANCE,
    Commands,
    OnTopic,
    Sent,
    is_every,
    messages_at_once,
    newest_run,
    period,
)

__all__ = ['exercise']

WORDS = words_of(__file__)

WHERE = OnTopic('/cmd_vel', 'geometry_msgs/msg/Twist')
WANTED = {'linear.x': 0.2, 'angular.z': 0.5}
COUNT, HZ = 5, 10
ALLOWED = f'{figure(HZ * (1 - TOLERANCE))} to {figure(HZ * (1 + TOLERANCE))}'


def _told_by(
    fits: Callable[[Mapping[str, float]], bool], name: str, why: str, *change: tuple[str, str]
) -> tuple[Callable[[Mapping[str, float]], bool], Mistake]:
    todo = 'Write {{linear: {{x: ...}}, angular: {{z: ...}}}}.'
    return fits, Mistake(f'drive/{name}', why, todo, change=change)


FIELDS = (
    _told_by(
        lambda used: not all(map(math.isfinite, used.values())),
        'not-a-number',
        'A speed is a number. nan is none, and no robot can drive at inf.',
        ('0.2}', '0.2, y: .nan}'),
    ),
    _told_by(
        lambda used: used == {'linear.x': 0.5, 'angular.z': 0.2},
        'numbers-exchanged',
        'The two numbers are exchanged.',
        ('x: 0.2}, angular: {z: 0.5', 'x: 0.5}, angular: {z: 0.2'),
    ),
    _told_by(
        lambda used: 'angular.x' in used,
        'messages-exchanged',
        'linear and angular are exchanged: linear is for driving, angular for turning.',
        ('linear: {x: 0.2}, angular: {z: 0.5}', 'angular: {x: 0.2}, linear: {z: 0.5}'),
    ),
    _told_by(
        lambda used: used.get('linear.x', 0.0) < 0.0,
        'backwards',
        'A negative linear.x drives back. Leave the minus away.',
        ('x: 0.2', 'x: -0.2'),
    ),
    _told_by(
        lambda used: used.get('angular.z', 0.0) < 0.0,
        'to-the-right',
        'A turn to the left is positive, to the right negative.',
        ('z: 0.5', 'z: -0.5'),
    ),
    _told_by(
        lambda used: used.get('angular.z', 0.0) > 6.0,
        'degrees',
        'Angles are in radians: 0.5 rad is about 29 degrees.',
        ('z: 0.5', 'z: 28.6'),
    ),
    _told_by(
        lambda used: 'angular.y' in used or 'linear.z' in used,
        'wrong-axis',
        'x points forwards, y to the left, z upwards. A robot on the ground turns about z.',
        ('z: 0.5', 'y: 0.5'),
    ),
    _told_by(
        lambda used: True,
        'other-fields',
        'linear holds the speeds in m/s, angular the turning in rad/s; x, y and z are the '
        'axes. Fields that are not named stay 0.',
        ('0.2}', '0.2, y: 0.1}'),
    ),
)
NO_END = WORDS.mistake('drive/without-an-end')
TWO_AT_ONCE = WORDS.mistake('drive/two-at-once')
TOO_EARLY = WORDS.mistake('drive/too-early')
TOO_FEW = WORDS.mistake('drive/one-message')
OTHER_RATE = WORDS.mistake('drive/too-slow')


def _expect_fields(sent: Sent) -> None:
    for sample in newest_run(sent.samples):
        seen = {
            f'{part}.{axis}': getattr(getattr(sample.message, part), axis)
            for part in ('linear', 'angular')
            for axis in 'xyz'
        }
        if all(abs(value - WANTED.get(name, 0.0)) < 1e-6 for name, value in seen.items()):
            continue
        used = {name: value for name, value in seen.items() if value}
        raise Fail(
            'linear.x = 0.2 and angular.z = 0.5, all else 0, in every message',
            ', '.join(
                f'{name} = {digits(value, WANTED.get(name, 0.0))}' for name, value in used.items()
            )
            or 'all fields are 0',
            next(mistake for fits, mistake in FIELDS if fits(used)),
        )


def _is_slow(run: Sequence[Sample]) -> bool:
    # A busy machine delays messages, but not to several times their period.
    return len(run) > 2 and period(run) > 0.4


def _expect_count(sent: Sent) -> None:
    samples, run = sent.samples, newest_run(sent.samples)
    if sent.is_running and _is_slow(run):
        return  # the rate says so at once
    if sent.is_running and len(run) < COUNT:
        raise NotAttempted(
            f'{len(run)} of {COUNT} messages have come, and the command still runs. Run this cell '
            'again when it has ended.'
        )
    first, last = run[0].number, run[-1].number
    # A message that was lost on its way was sent all the same.
    count, others = last - first + 1, messages_at_once(samples, run)
    seen, mistake = f'{count} of them', NO_END if count > COUNT else TOO_FEW
    if others:
        seen += f', and {others} of another publisher at the same time'
        mistake = TWO_AT_ONCE
    elif count < COUNT and first > 1 and first - 1 not in {s.number for s in samples}:
        seen, mistake = f'the last {count} of {last}', TOO_EARLY
    if count != COUNT or others:
        raise Fail(f'{COUNT} messages on {WHERE.topic}, of one command', seen, mistake)


def _expect_rate(sent: Sent) -> None:
    run = newest_run(sent.samples)
    if not is_every(1 / HZ, run, commanded_rate(WHERE.topic)):
        raise Fail(
            f'a message every {figure(1 / HZ)} s ({ALLOWED} a second)',
            f'a message every {figure(period(run))} s ({figure(1 / period(run))} a second)',
            OTHER_RATE,
        )


exercise = Exercise(
    words=WORDS,
    clauses=(
        WHERE,
        Asked(
            WORDS.clause('expect-fields'),
            _expect_fields,
        ),
        Asked(
            WORDS.of(count=in_words(COUNT), digits=COUNT).clause('expect-count'),
            _expect_count,
        ),
        Asked(
            WORDS.of(
                times=in_words(HZ),
                hz=HZ,
                lowest=figure(HZ * (1 - TOLERANCE)),
                highest=figure(HZ * (1 + TOLERANCE)),
            ).clause('expect-rate'),
            _expect_rate,
        ),
    ),
    shared=[WHERE.topic],
    reliable=[WHERE.topic],
    records=[WHERE.topic],
    stage=Commands(
        WHERE,
        f'{COUNT} messages on /cmd_vel with linear.x = 0.2 and angular.z = 0.5',
        f'{COUNT} messages came, ten a second: forwards, and to the left.',
        is_whole=lambda samples: bool(samples) and len(newest_run(samples)) == COUNT,
        is_too_much=lambda came: len(newest_run(came)) > COUNT or _is_slow(newest_run(came)),
    ),
)
