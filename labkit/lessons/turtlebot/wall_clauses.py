"""What the check of the exercise wall asks for."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass

from labkit.exercises import Fail
from labkit.exercises.clauses import Clause, Evidence
from labkit.lessons.turtlebot.clauses import DriveClause, short
from labkit.lessons.turtlebot.drive import SCAN, TWIST, Drive, Trial
from labkit.sim.kinematics import BURGER

__all__ = ['SIGN', 'DrivesOn', 'Scans', 'Speed', 'StopsInTime', 'draw', 'tell']

SIGN = '/go_wall'
# The walls of the robot's room stand so far from the origin, m.
WALL = 2.5
# It has to drive so fast, m/s, and to stop if something ahead is nearer than this, m.
SPEED, NEAR = 0.2, 0.5
# How far a speed may be off, m/s; and a distance for which both is right, to stop and to go on, m.
SAME, EITHER = 1e-6, 1e-3
# Ahead are the first beam, and so many on each side of it.
BESIDE = 9
# The fewest commands a second, and how late the stop command may be, s.
FEWEST_HZ = 5.0
LATE_SEC = 0.2


@dataclass(frozen=True)
class Scans(Clause):
    """The node subscribes to the scan, as one subscribes to a sensor."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return f'subscribe to `/scan` (`{short(SCAN)}`), *best effort*'

    def find(self, evidence: Evidence) -> None:
        """Look at the subscription to the laser's scan."""
        scan = evidence.subscription('/scan', evidence.subscription(SIGN).node)
        if scan.qos.reliability.name != 'BEST_EFFORT':
            raise Fail(
                '/scan with reliability best_effort',
                f'{scan.node} subscribes with reliability {scan.qos.reliability.name.lower()}',
                why='A sensor sends without waiting for receipts: best effort. A subscription '
                'that asks for receipts does not match it, and never hears it.',
                todo='Pass qos_profile_sensor_data in the place of the depth.',
            )


@dataclass(frozen=True)
class Speed(DriveClause):
    """It drives straight ahead, at one speed."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return (
            f'publish `linear.x` = {SPEED}, all else 0.0, on `/cmd_vel` (`{short(TWIST)}`), at '
            f'least {FEWEST_HZ:.0f} times a second'
        )

    def look(self, found: Drive) -> None:
        """Look at one drive."""
        _look_how_often(found)
        for command in found.moving:
            if abs(command.v - SPEED) < SAME and not (command.w or command.others):
                continue
            if command.stops:
                continue  # that is another clause's affair
            raise Fail(
                f'linear.x = {SPEED} m/s, and 0.0 in all other numbers',
                f'a command with {command}',
                why='It drives backwards.'
                if command.v == -SPEED
                else 'It has another speed.'
                if not command.w
                else 'It turns, so the beams look elsewhere than it goes.',
                todo=f'msg.linear.x = {SPEED}',
            )


def _look_how_often(found: Drive) -> None:
    """Raise Fail if the command is not repeated."""
    gaps = found.gaps
    if len(found.moving) == 1 and not found.ending:
        gaps = [math.inf]
    longest = 1.25 / FEWEST_HZ + found.margin
    if not gaps or max(gaps) <= longest:
        return
    once = len(found.moving) < 3
    raise Fail(
        f'a command every {1 / FEWEST_HZ} s, or more often',
        'one command' if once else f'{max(gaps):.2g} s from one to the next',
        why='A robot obeys a command for one second only, and then stops. Whoever wants it '
        'to drive on has to say so again and again.',
        todo='Publish in a timer of 0.1 s.',
    )


@dataclass(frozen=True)
class StopsInTime(DriveClause):
    """It stops at the first scan that sees something near ahead."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return (
            f'stop within {LATE_SEC} s after the first scan with something ahead nearer than '
            f'{NEAR} m'
        )

    def look(self, found: Drive) -> None:
        """Look at one drive."""
        near = [
            at for at, ranges in found.scans if at >= found.sign and _ahead(ranges) < NEAR - EITHER
        ]
        expected = f'it stops within {LATE_SEC} s after the first scan below {NEAR} m ahead'
        stop = found.ending[0].at if found.ending else math.inf
        if near and stop > near[0] + LATE_SEC + found.margin:
            way = min(_ahead(ranges) for at, ranges in found.scans if at <= stop)
            if found.ending or found.cut:
                raise Fail(
                    expected,
                    f'the wall came as near as {way:.2f} m',
                    why='It saw the wall too late, or looked elsewhere: ranges[0] looks ahead, '
                    'ranges[180] back.',
                    todo=f'Compare the nearest of the beams ahead with {NEAR} m at each step.',
                )


@dataclass(frozen=True)
class DrivesOn(DriveClause):
    """Nothing else stops it."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return 'nothing beside or behind stops it, nor a distance of `inf` or 0.0'

    def look(self, found: Drive) -> None:
        """Look at one drive."""
        if not found.ending:
            return
        stop = found.ending[0].at + found.margin
        heard = [ranges for at, ranges in found.scans if at <= stop]
        if any(_ahead(ranges) < NEAR + EITHER for ranges in heard):
            return
        last = heard[-1] if heard else [math.inf]
        why = 'It stopped too early: by its odometry, or at another distance.'
        todo = f'Compare msg.ranges[:10] and msg.ranges[-10:] with {NEAR} m.'
        if last[0] == 0.0:
            why = '0.0 m was taken for a wall. A real scanner says 0.0 where a beam met nothing.'
            todo = 'Leave distances of 0.0 out before you look for the nearest one.'
        elif min((way for way in last if way > 0), default=math.inf) < NEAR:
            why = 'Something beside or behind the robot was taken for the wall ahead. ranges[0] '
            why += 'looks ahead, and the next beams go round to the left.'
            todo = 'Look at the beams around index 0 only: msg.ranges[:10] and msg.ranges[-10:]'
        elif found.way() < 0.02 and math.isinf(_ahead(last)):
            why = 'It has hardly moved: it takes inf for a wall, or looks at a wrong beam.'
        ahead = _ahead(last)
        seen = 'nothing' if math.isinf(ahead) else f'{ahead:.2f} m'
        raise Fail(
            f'it drives on until something ahead is nearer than {NEAR} m',
            f'it stopped after {found.way():.2f} m, and the scan sees {seen} ahead',
            why=why,
            todo=todo,
        )


def _ahead(ranges: Sequence[float]) -> float:
    """Return the nearest distance ahead, m; inf if there is nothing."""
    beams = (*ranges[: BESIDE + 1], *ranges[-BESIDE:])
    return min((way for way in beams if way > 0), default=math.inf)


def draw() -> list[Trial]:
    """Return drives with nothing beside, with a wall beside, a post behind, and 0.0 for nothing.

    Facing one of the four walls, as seen from the middle: `ahead` is how far it is, `side` how far
    to the left the robot stands.
    """
    nine = math.pi / 2

    def facing(turns: int, ahead: float, side: float) -> tuple[float, float, float]:
        x, y = WALL - ahead - BURGER.scan_x, side
        for _ in range(turns % 4):
            x, y = -y, x
        return x, y, turns * nine

    # Lanes in which no post is nearer than 0.5 m; and those along a wall, in the corner at x = 2.5
    # m, y = -2.5 m, where there is no post.
    free = [(0, -0.6, 0.6), (1, -0.6, 0.6), (2, -0.5, 0.6), (3, -0.2, 0.9)]
    turns, low, high = random.choice(free)
    other, least, most = random.choice(free)
    beside = WALL - random.uniform(0.3, 0.4)
    along = random.choice(
        (
            facing(0, random.uniform(0.75, 1.0), -beside),
            facing(3, random.uniform(0.75, 1.0), beside),
        )
    )
    off = random.uniform(0.0, 0.05)
    behind = random.choice(((-1.7, 1.62 + off, nine), (-1.62 - off, -1.7, 2 * nine)))
    return [
        Trial(facing(turns, random.uniform(0.8, 1.2), random.uniform(low, high))),
        Trial(along),
        Trial(behind),
        Trial(
            facing(other, random.uniform(1.2, 1.3), random.uniform(least, most)),
            short_sighted=True,
        ),
    ]


def tell(drives: Sequence[Drive]) -> str:
    """Say what was seen."""
    gaps = [_ahead(found.scans[-1][1]) for found in drives]
    return f'It stopped {", ".join(f"{gap:.2f} m" for gap in gaps)} in front of the walls.'
