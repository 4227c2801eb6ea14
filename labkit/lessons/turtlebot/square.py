"""Exercise: drive a square."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise, starmap
from typing import Any

from labkit.exercises import Clause, Exercise, Fail, Probe, Solution, words_of
from labkit.exercises.clauses import Asked, Evidence
from labkit.exercises.figures import figure
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

WORDS = words_of(__file__)

SIGN = ('/go_square', EMPTY)
# Sides of variants, m. The corner opposite to the start is in none near that of another.
SIDES = (0.24, 0.4, 0.56, 0.72)
# How far it may be off a corner, m.
NEAR = 0.1
# What it turns while it drives is none of the turns on the spot, m/s; it may be so much, degrees.
DRIVES, CURVED = 0.05, 180.0
# An unhurried drive: m/s along a side, and s for each turn with its pauses.
UNHURRIED, TURN_SEC = 0.2, 3.5

OFF_THE_SIDES = WORDS.mistake('square/off-the-sides')
FIVE_SIDES = WORDS.mistake('square/five-sides')
OTHER_WAY = WORDS.mistake('square/other-way')
FIRST_SIDE = WORDS.mistake('square/first-side')
LAST_SIDE = WORDS.mistake('square/last-side')
NO_RIGHT_ANGLE = WORDS.mistake('square/no-right-angle')


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
    corners = ', '.join(f'({figure(x)}, {figure(y)})' for x, y in outline.corners[1:])
    return Fail(
        f'corners at {corners} m, seen from the start',
        f'it came no nearer to corner {number}, ({figure(corner[0])}, {figure(corner[1])}), than '
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
    """Return some drives. They are not along an axis: a square is one wherever it begins."""
    uniform = random.uniform
    return [
        Trial(
            (uniform(-0.4, 0.4), uniform(-0.4, 0.4), uniform(-3, 3)),
            goals=outline.corners[1:],
            from_start=True,
        )
        for _ in range(random.randint(2, 3))
    ]


def _tell(drives: Sequence[Drive]) -> str:
    drive = drives[0]
    away = math.dist(drive.end[:2], drive.start[:2])
    return f'A square of {drive.way():.2f} m, closed to {away:.2f} m, in {drive.duration:.0f} s.'


def _variant(*, outline: tuple[float, str] = (0.4, 'left')) -> Exercise:
    wanted = Outline(*outline)
    side, turn = outline
    seconds = side / UNHURRIED
    words = WORDS.of(
        side=side,
        turn=turn,
        sign='' if turn == 'left' else '-',
        near=NEAR,
        within=f'{wanted.seconds:.0f}',
        speed=UNHURRIED,
        seconds=figure(seconds),
        steps=f'{seconds / STEP_SEC:.0f}',
        step=STEP_SEC,
        rate=RATE,
        rest=figure(REST_SEC),
    )
    clauses: tuple[Clause[Drive], ...] = (
        Begins(*SIGN),
        SENSIBLE,
        Asked(words.clause('rate'), partial(look_at_rate, pause=REST_SEC, pauses=8)),
        Asked(words.clause('sides'), partial(_sides, wanted)),
        RESTS,
        Asked(words.clause('closes'), partial(_closes, wanted)),
    )
    answer = Solution.of(words).changed(
        ('20 * [(0.2, 0.0)]', f'{seconds / STEP_SEC:.0f} * [({UNHURRIED}, 0.0)]')
    )
    if turn == 'right':
        answer = answer.changed(('1.5708', '-1.5708'))
    return Exercise(
        words=words,
        shared=['/cmd_vel'],
        reliable=['/cmd_vel'],
        clauses=clauses,
        stage=Drives(SIGN, partial(_draw, wanted), _tell, seconds=wanted.seconds),
        answer=answer,
    )


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
    _variant(),
    _variant,
    _guess,
    outline=[
        (side, turn)
        for side in SIDES
        for turn in ('left', 'right')
        if Outline(side, turn) != Outline()
    ],
)
