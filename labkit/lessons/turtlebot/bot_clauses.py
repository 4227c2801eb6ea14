"""What the check of the exercise bot asks for."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass

from labkit.exercises import Fail
from labkit.lessons.turtlebot.clauses import (
    DriveClause,
    Rate,
    short,
)
from labkit.lessons.turtlebot.drive import TWIST, Drive, Trial

__all__ = ['Gain', 'Steps', 'draw', 'tell']

STEPS = 20
HOME = (0.0, 0.0)
# How old the odometry may be that a command follows, s: that of the step before is right, too.
STEP_SEC = 0.1
# How far a command may be from what is asked for, m/s.
SAME = 1e-6


@dataclass(frozen=True)
class Gain(DriveClause):
    """Each command asks for v = -x."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return '`linear.x` = -x with the newest odometry (or that of a step before), all else 0.0'

    def look(self, found: Drive) -> None:
        """Look at one drive."""
        if not found.commands:
            return
        x = found.start.x
        expected = f'the first command with linear.x = {-x:.2f} m/s where x = {x:.2f} m: v = -x'
        if not found.moving:
            raise Fail(
                expected,
                'only commands that say stop',
                why='A robot that stands has the speed 0.0, and twist.twist in an Odometry is the '
                'speed. The place is in pose.pose.',
                todo='self.x = msg.pose.pose.position.x',
            )
        first = found.moving[0]
        if abs(first.v + found.start.y) < SAME:
            raise Fail(
                expected,
                f'linear.x = {first.v:.2f} m/s, where y = {found.start.y:.2f} m',
                why='That is y. Home is where x = 0.',
                todo='self.x = msg.pose.pose.position.x',
            )
        if first.v * x > 0:
            raise Fail(
                expected,
                f'linear.x = {first.v:.2f} m/s: it drives away from home',
                why='The sign is wrong. Where x is below 0 the robot has to drive forwards, where '
                'it is above 0 backwards.',
                todo='v = -x',
            )
        for number, command in enumerate(found.moving[: STEPS + 1], start=1):
            known = [
                pose.x
                for pose in found.seen(
                    command.at + found.margin, since=STEP_SEC + 2 * found.margin
                )
            ]
            if command.w or command.others:
                raise Fail(
                    'linear.x = -x, and 0.0 in all other numbers',
                    f'step {number} says {command}',
                    why='The bot drives straight on: home is where x = 0, whatever y is.',
                    todo='Set msg.linear.x alone.',
                )
            if min(known) - SAME <= -command.v <= max(known) + SAME:
                continue
            raise Fail(
                f'v = -x at every step, so linear.x = {-known[-1]:.3f} m/s where '
                f'x = {known[-1]:.3f} m',
                f'linear.x = {command.v:.3f} m/s there, in step {number}',
                why=_misconception(found, number),
                todo='Let the callback keep x, and read it anew at each step.',
            )


def _misconception(found: Drive, number: int) -> str:
    v, x = found.moving[number - 1].v, found.start.x
    if math.isnan(v):
        return 'nan is no number: something was divided by 0.0, or never set.'
    if number == 1 and abs(x) > SAME:
        return f'The gain is 1 here: v = -1.0 * x. This is {-v / x:.2g} * x, the other way.'
    if v == found.moving[0].v:
        return 'The command does not follow the newest odometry: it stays as it was at the start.'
    return 'The command does not follow the newest odometry.'


@dataclass(frozen=True)
class Steps(DriveClause):
    """So many steps are taken."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return f'publish {STEPS} steps on `/cmd_vel` (`{short(TWIST)}`), ten a second (2 % off)'

    def look(self, found: Drive) -> None:
        """Look at one drive."""
        count = len(found.moving)
        if not count:
            return
        Rate().look(found)
        if count == STEPS:
            return
        off = 'One too many.' if count == STEPS + 1 else 'One too few.'
        raise Fail(
            f'{STEPS} steps',
            f'{count} steps' + (', and no end' if found.cut else ''),
            why=off
            if abs(count - STEPS) == 1
            else 'The steps are not counted, or not to the right number.',
            todo=f'Count each step, and stop when {STEPS} are done.',
        )


def draw() -> list[Trial]:
    """Return two drives, one on each side of home."""
    side = random.choice((-1, 1))
    return [
        Trial(
            (way, random.uniform(-0.4, 0.4), random.uniform(-0.2, 0.2)),
            goals=[HOME],
        )
        for way in (side * random.uniform(0.12, 0.2), -side * random.uniform(0.12, 0.2))
    ]


def tell(drives: Sequence[Drive]) -> str:
    """Say what was seen."""
    steps = f'{STEPS} steps from x = {drives[0].start.x:.2f} m to x = {drives[0].end.x:.2f} m'
    return f'{steps}, then stop. Each of {len(drives)} times.'
