"""Exercise: the class Bot, which drives home by its odometry."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Fail, Mistake, Solution
from labkit.exercises.clauses import Asked
from labkit.exercises.expect import digits
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

SIGN = ('/go_home', EMPTY)
STEPS = 20

_PLACE = 'self.x = msg.pose.pose.position.x'
SPEED_FOR_PLACE = Mistake(
    'bot/speed-for-place',
    'A robot that stands has the speed 0.0, and twist.twist in an Odometry is the speed. The '
    'place is in pose.pose.',
    _PLACE,
    change=[('msg.pose.pose.position.x', 'msg.twist.twist.linear.x')],
)
Y_FOR_X = Mistake(
    'bot/y-for-x', 'That is y. Home is where x = 0.', _PLACE, change=[('position.x', 'position.y')]
)
WRONG_SIGN = Mistake(
    'bot/wrong-sign',
    'The sign is wrong. Where x is below 0 the robot has to drive forwards, where it is above 0 '
    'backwards.',
    'v = -x',
    change=[('= -self.x', '= self.x')],
)
TURNS = Mistake(
    'bot/turns',
    'The bot drives straight on: home is where x = 0, whatever y is.',
    'Set msg.linear.x alone.',
    change=[('linear.x = -self.x\n', 'linear.x = -self.x\n            msg.angular.z = 0.1\n')],
)
_ANEW = 'Let the callback keep x, and read it anew at each step.'
GAIN = Mistake(
    'bot/gain',
    'The gain is 1 here: v = -1.0 * x. This is {gain:.5g} * x, the other way.',
    _ANEW,
    change=[('= -self.x', '= -1.1 * self.x')],
)
AS_AT_START = Mistake(
    'bot/as-at-start',
    'The command does not follow the newest odometry: it stays as it was at the start.',
    _ANEW,
)
NOT_COUNTED = Mistake(
    'bot/not-counted',
    'The steps are not counted, or not to the right number.',
    f'Count each step, and stop when {STEPS} are done.',
    change=[('        self.steps -= 1\n', '')],
)


def _steps(drive: Drive) -> None:
    count = len(drive.moving)
    if not count:
        return
    look_at_rate(drive)
    if count != STEPS:
        seen = f'{count} steps' + (', and no end' if drive.cut else '')
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
        expected = f'v = -x at every step, so linear.x = {right} m/s where x = {newest:.4g} m'
        seen = f'linear.x = {told} m/s there, in step {number}'
        mistake = AS_AT_START if command.v == first else None
        if math.isnan(command.v):
            mistake = NAN
        elif number == 1:
            mistake = GAIN.of(gain=-command.v / x)
        raise Fail(expected, seen, mistake, todo=_ANEW)


def _draw() -> list[Trial]:
    """Return two drives, one on each side of home, one of them from where -x is a high speed."""
    side = random.choice((-1, 1))
    ways = [side * random.uniform(0.12, 0.2), -side * random.uniform(0.3, 0.4)]
    random.shuffle(ways)
    return [
        Trial((way, random.uniform(-0.4, 0.4), random.uniform(-0.2, 0.2)), goals=[(0.0, 0.0)])
        for way in ways
    ]


def _tell(drives: Sequence[Drive]) -> str:
    steps = f'{STEPS} steps from x = {drives[0].start.x:.2f} m to x = {drives[0].end.x:.2f} m'
    return f'{steps}, then stop. Each of {len(drives)} times.'


exercise = Exercise(
    name='bot',
    task=f'On /go_home a node drives v = -x for {STEPS} steps at 10 Hz, by its odometry, and '
    'stops.',
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    clauses=(
        Begins(*SIGN),
        Hears('/odom', ODOMETRY, SIGN[0]),
        Asked(f'publish {STEPS} steps on `/cmd_vel` (`Twist`), {MANY} {PER_SECOND}', _steps),
        Asked(
            '`linear.x` = -x with the newest odometry (or that of a step before), all else 0.0',
            _gain,
        ),
        STOPS,
    ),
    # A right drive takes 2 s.
    stage=Drives(SIGN, _draw, _tell, seconds=5.0),
    hints=[
        'Three callbacks: the odometry keeps x, the message on /go_home sets a counter, the timer '
        'does one step.',
        'In the timer: nothing if the counter is 0. Else count down, make a Twist, set '
        'msg.linear.x = -self.x, publish.',
        f'The stop command is one more step, with an empty Twist(): begin the counter with '
        f'{STEPS + 1}.',
    ],
    answer=Solution(
        __file__,
        'bot.py',
        'The callbacks only keep what is new. The timer alone decides when a command is sent, so '
        'the rate is 10 Hz, however often the odometry comes.',
    ),
)
