"""Exercise: drive a square."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise, starmap
from typing import Any

from labkit.exercises import Clause, Exercise, Fail, Mistake, Probe, Solution
from labkit.exercises.clauses import Asked, Evidence
from labkit.exercises.variants import varied
from labkit.lessons.turtlebot.drive import EMPTY, STEP_SEC, Drive, Point, Trial
from labkit.lessons.turtlebot.drive_clauses import (
    RATE,
    REST_SEC,
    RESTS,
    SENSIBLE,
    Begins,
    look_at_rate,
    look_at_time,
)
from labkit.lessons.turtlebot.stage import Drives, Trials
from labkit.sim.kinematics import wrap_angle
from labkit.views.arena_picture import two

__all__ = ['exercise']

SIGN = ('/go_square', EMPTY)
# Sides of variants, m. The corner opposite to the start is in none near that of another.
SIDES = (0.24, 0.4, 0.56, 0.72)
# How far it may be off a corner, m.
NEAR = 0.1
# What it turns while it drives is none of the turns on the spot, m/s; it may be so much, degrees.
DRIVES, CURVED = 0.05, 180.0
# An unhurried drive: m/s along a side, and s for each turn with its pauses.
UNHURRIED, TURN_SEC = 0.2, 3.5

OFF_THE_SIDES = Mistake(
    'square/off-the-sides',
    'It drives a curve, or a side is longer than it should be.',
    'A command for a side has angular.z = 0.0, one for a turn linear.x = 0.0.',
)
FIVE_SIDES = Mistake(
    'square/five-sides',
    'It goes on after the fourth side.',
    'After the fourth side publish an empty Twist().',
    change=[('4 *', '5 *')],
)
OTHER_WAY = Mistake(
    'square/other-way',
    'It turns to the {other}. A positive angular.z turns to the left, a negative one to the '
    'right.',
    'Change the sign of angular.z.',
)
FIRST_SIDE = Mistake(
    'square/first-side',
    'The first side has another length, or it did not drive straight on.',
    f'Way = speed times time: {UNHURRIED} m/s for {STEP_SEC} s, one step, are '
    f'{UNHURRIED * STEP_SEC:g} m.',
)
LAST_SIDE = Mistake(
    'square/last-side',
    'The fourth side is missing, or the corners are no right angles.',
    'Four times the same: a side, then a turn.',
    change=[('4 *', '3 *')],
)
NO_RIGHT_ANGLE = Mistake(
    'square/no-right-angle',
    'The turn is no right angle, or the side has another length. A right angle is 1.57 rad.',
    f'Angle = turning rate times time: 1.57 rad/s for 1 s, which is 10 steps of {STEP_SEC} s.',
    change=[('1.5708', '1.0')],
)


@dataclass(frozen=True)
class Outline:
    """The square that is to be driven: the length of its sides, m, and which way it turns."""

    side: float = 0.4
    turn: str = 'left'

    @property
    def corners(self) -> tuple[Point, ...]:
        """The corners, seen from the start, which is the first and the last: x ahead, m."""
        side = self.side
        across = side if self.turn == 'left' else -side
        return (0.0, 0.0), (side, 0.0), (side, across), (0.0, across), (0.0, 0.0)

    def off(self, point: Point) -> float:
        """Return how far a point is from the nearest side, m, along an axis."""
        (x, y), half = point, self.side / 2
        middle = self.corners[2][1] / 2
        return abs(max(abs(x - half), abs(y - middle)) - half)

    @property
    def seconds(self) -> float:
        """How long the drive may take, s."""
        return float(round(4 * (self.side / UNHURRIED + TURN_SEC)))


def _path(drive: Drive) -> list[Point]:
    return [drive.told(pose)[:2] for _, pose in drive.poses]


def _sides(outline: Outline, drive: Drive) -> None:
    path, after = _path(drive), 0
    for number, corner in enumerate(outline.corners[1:], start=1):
        near = [i for i in range(after, len(path)) if math.dist(path[i], corner) <= NEAR]
        if not near:
            raise _missed(drive, path[after:], number, outline)
        after = near[0]
    outside = max(path[: after + 1], key=outline.off)
    if outline.off(outside) > NEAR:
        seen = f'it came to ({two(outside[0])}, {two(outside[1])}), seen from the start'
        raise Fail('a way along the sides of the square', seen, OFF_THE_SIDES)
    curved = math.degrees(
        sum(
            abs(wrap_angle(other.yaw - one.yaw))
            for (at, one), (later, other) in pairwise(drive.poses)
            if math.dist(one[:2], other[:2]) > DRIVES * (later - at)
        )
    )
    if curved > CURVED:
        seen = f'it turned by {curved:.0f} degrees while it drove'
        raise Fail('straight sides, and turns on the spot', seen, OFF_THE_SIDES)


def _missed(drive: Drive, path: Sequence[Point], number: int, outline: Outline) -> Fail:
    if drive.cut:
        look_at_time(drive, outline.seconds)
    corner = outline.corners[number]
    x, y = min(path, key=lambda point: math.dist(point, corner))
    mistake = {1: FIRST_SIDE, 4: LAST_SIDE}.get(number, NO_RIGHT_ANGLE)
    mirrored = (corner[0], -corner[1])
    if number == 2 and any(math.dist(point, mirrored) <= NEAR for point in path):
        mistake = OTHER_WAY
    corners = ', '.join(f'({x:g}, {y:g})' for x, y in outline.corners[1:])
    return Fail(
        f'corners at {corners} m, seen from the start',
        f'it came no nearer to corner {number}, ({corner[0]:g}, {corner[1]:g}), than '
        f'({two(x)}, {two(y)})' + (', and was still driving' if drive.cut else ''),
        mistake.of(other='right' if outline.turn == 'left' else 'left'),
    )


def _closes(outline: Outline, drive: Drive) -> None:
    look_at_time(drive, outline.seconds)
    if drive.cut:
        return
    path = _path(drive)
    away, way = math.dist(path[-1], outline.corners[-1]), sum(starmap(math.dist, pairwise(path)))
    # It may be as long as six sides of the square.
    if away > NEAR or way >= 6 * outline.side:
        seen = f'it ends {away:.2f} m away from there, after {way:.1f} m'
        raise Fail('it ends where it began, after four sides', seen, FIVE_SIDES)


def _draw(outline: Outline) -> list[Trial]:
    """Return two drives. They are not along an axis: a square is one wherever it begins."""
    uniform = random.uniform
    return [
        Trial(
            (uniform(-0.4, 0.4), uniform(-0.4, 0.4), uniform(-3, 3)),
            goals=outline.corners[1:],
            from_start=True,
        )
        for _ in range(2)
    ]


def _tell(drives: Sequence[Drive]) -> str:
    drive = drives[0]
    away = math.dist(drive.end[:2], drive.start[:2])
    return f'A square of {drive.way():.2f} m, closed to {away:.2f} m, in {drive.duration:.0f} s.'


def _task(outline: Outline) -> dict[str, Any]:
    """Return what depends on the outline."""
    side, turn = outline.side, outline.turn
    sign = '' if turn == 'left' else '-'
    clauses: tuple[Clause[Drive], ...] = (
        Begins(*SIGN),
        SENSIBLE,
        Asked(
            f'{RATE}, with pauses of up to {REST_SEC:g} s',
            partial(look_at_rate, pause=REST_SEC, pauses=8),
        ),
        Asked(
            f'drive four straight sides of {side} m, turning 90° {turn} on the spot (corners up '
            f'to {NEAR} m off)',
            partial(_sides, outline),
        ),
        RESTS,
        Asked(
            f'stop where you began (up to {NEAR} m off), within {outline.seconds:.0f} s',
            partial(_closes, outline),
        ),
    )
    return {
        'task': f'On /go_square a node drives a square of {side} m to the {turn}, and stops where '
        'it began.',
        'clauses': clauses,
        'stage': Drives(SIGN, partial(_draw, outline), _tell, seconds=outline.seconds),
        'hints': [
            f'A square is four times the same: a side, then a turn of 90 degrees to the {turn}.',
            f'Way = speed * time. {UNHURRIED} m/s for {side / UNHURRIED:g} s are {side} m: '
            f'{side / UNHURRIED / STEP_SEC:.0f} steps of {STEP_SEC} s. Angle = turning rate * '
            f'time. {sign}1.57 rad/s for 1 s are 90 degrees to the {turn}: 10 steps.',
            'Make a list of (v, w), one for each step, and let the timer take one at a time. '
            'Let it rest for some steps, (0.0, 0.0), after each side and each turn.',
        ],
    }


_USUAL = Exercise(
    name='square',
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    answer=Solution(
        __file__,
        'square.py',
        'Nothing is measured here: it relies on speed and time. By odometry it would be more '
        'exact, as in the exercise before.',
    ),
    **_task(Outline()),
)


def _variant(*, outline: tuple[float, str]) -> Exercise:
    wanted = Outline(*outline)
    steps = f'{wanted.side / UNHURRIED / STEP_SEC:.0f} * [({UNHURRIED}, 0.0)]'
    answer = _USUAL.answer.changed(('20 * [(0.2, 0.0)]', steps))
    if wanted.turn == 'right':
        answer = answer.changed(('1.5708', '-1.5708'))
    return replace(_USUAL, answer=answer, **_task(wanted))


def _guess(probe: Probe) -> dict[str, Any] | None:
    longest = max(map(Outline, SIDES), key=lambda outline: outline.side)
    trials = Trials(Evidence(probe), SIGN, longest.seconds)
    trials.wait_until_quiet()
    path = _path(next(trials.made(_draw(longest), [])))
    if not path:
        return None
    far = max((y for _, y in path), key=abs)
    side = min(SIDES, key=lambda side: abs(side - abs(far)))
    return {'outline': (side, 'left' if far > 0 else 'right')}


exercise = varied(
    _USUAL,
    _variant,
    _guess,
    outline=[
        (side, turn)
        for side in SIDES
        for turn in ('left', 'right')
        if Outline(side, turn) != Outline()
    ],
)
