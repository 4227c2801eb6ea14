"""Exercise: the class Bot, which drives home by its odometry."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import Asked
from labkit.exercises.expect import digits
from labkit.exercises.figures import figure, many
from labkit.lessons.turtlebot.drive import EMPTY, ODOMETRY, SAME, STEP_SEC, Drive, Trial
from labkit.lessons.turtlebot.drive_clauses import (
    MANY,
    NAN,
    PER_SECOND,
    STOPS,
    Begins,
    Hears,
    look_at_rate,
)
from labkit.lessons.turtlebot.stage import Drives

__all__ = ['exercise']

WORDS = words_of(__file__)

SIGN = ('/go_home', EMPTY)
STEPS = 20

SPEED_FOR_PLACE = WORDS.mistake('bot/speed-for-place')
Y_FOR_X = WORDS.mistake('bot/y-for-x')
WRONG_SIGN = WORDS.mistake('bot/wrong-sign')
TURNS = WORDS.mistake('bot/turns')
_ANEW = 'Let the callback keep x, and read it anew at each step.'
GAIN = WORDS.mistake('bot/gain')
AS_AT_START = WORDS.mistake('bot/as-at-start')
NOT_COUNTED = WORDS.mistake('bot/not-counted')


def _steps(drive: Drive) -> None:
    count = len(drive.moving)
    if not count:
        return
    look_at_rate(drive)
    if count != STEPS:
        seen = many(count, 'step') + (', and no end' if drive.cut else '')
        raise Fail(f'{STEPS} steps', seen, NOT_COUNTED)


def _gain(drive: Drive) -> None:
    x, y = drive.start[:2]
    expected = f'the first command with linear.x = {-x:.2f} m/s where x = {x:.2f} m: v = -x'
    if not drive.moving:
        raise Fail(expected, 'only commands that say stop', SPEED_FOR_PLACE)
    first = drive.moving[0].v
    if abs(first + y) < SAME:
        raise Fail(expected, f'linear.x = {first:.2f} m/s, where y = {y:.2f} m', Y_FOR_X)
    if first * x > 0:
        raise Fail(expected, f'linear.x = {first:.2f} m/s: it drives away from home', WRONG_SIGN)
    for number, command in enumerate(drive.moving[: STEPS + 1], start=1):
        if command.w or command.others:
            expected = 'linear.x = -x, and 0.0 in all other numbers'
            raise Fail(expected, f'step {number} says {command}', TURNS)
        # The odometry of the step before is right, too.
        since = STEP_SEC + 2 * drive.margin
        known = [pose.x for pose in drive.seen(command.at + drive.margin, since=since)]
        if min(known) - SAME <= -command.v <= max(known) + SAME:
            continue
        newest = known[-1]
        right, told = digits(-newest, command.v), digits(command.v, -newest)
        expected = (
            f'v = -x at every step, so linear.x = {right} m/s where x = {figure(newest, 4)} m'
        )
        seen = f'linear.x = {told} m/s there, in step {number}'
        mistake = AS_AT_START if command.v == first else None
        if math.isnan(command.v):
            mistake = NAN
        elif number == 1:
            mistake = GAIN.of(gain=figure(-command.v / x, 5))
        raise Fail(expected, seen, mistake, todo=_ANEW)


def _draw() -> list[Trial]:
    """Return drives on both sides of home, one of them from where -x is a high speed."""
    side = random.choice((-1, 1))
    ways = [side * random.uniform(0.12, 0.2), -side * random.uniform(0.3, 0.4)]
    ways += [side * random.uniform(0.12, 0.4) for _ in range(random.randint(1, 2))]
    random.shuffle(ways)
    return [
        Trial((way, random.uniform(-0.4, 0.4), random.uniform(-0.2, 0.2)), goals=[(0.0, 0.0)])
        for way in ways
    ]


def _tell(drives: Sequence[Drive]) -> str:
    steps = f'{STEPS} steps from x = {drives[0].start.x:.2f} m to x = {drives[0].end.x:.2f} m'
    return f'{steps}, then stop. Each of {len(drives)} times.'


exercise = Exercise(
    words=WORDS,
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    clauses=(
        Begins(*SIGN),
        Hears('/odom', ODOMETRY, SIGN[0]),
        Asked(WORDS.of(steps=STEPS, many=MANY, per_second=PER_SECOND).clause('steps'), _steps),
        Asked(
            WORDS.clause('gain'),
            _gain,
        ),
        STOPS,
    ),
    # A right drive takes 2 s.
    stage=Drives(SIGN, _draw, _tell, seconds=5.0),
)
