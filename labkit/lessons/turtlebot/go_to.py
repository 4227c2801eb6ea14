"""Exercise: go to a point, with the heading too."""

from __future__ import annotations

import math
import random
import statistics
from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise

from labkit.exercises import Exercise, Fail, Mistake, words_of
from labkit.exercises.clauses import Asked
from labkit.lessons.turtlebot.drive import ODOMETRY, STEP_SEC, Command, Drive, Point, Trial
from labkit.lessons.turtlebot.drive_clauses import (
    RATE,
    SENSIBLE,
    Begins,
    Hears,
    look_at_end,
    look_at_rate,
    look_at_time,
)
from labkit.lessons.turtlebot.stage import Drives
from labkit.sim.kinematics import wrap_angle

__all__ = ['exercise']

WORDS = words_of(__file__)

SIGN = ('/goal', 'geometry_msgs/msg/Pose2D')
# How near it has to come, and how much further off it may stand after braking, m.
NEAR, BRAKING = 0.05, 0.01
SECONDS = 14.0
# Goals are so far away, m.
WAY = (0.5, 1.0)
# Turning by less than this from the start is no decision, rad.
TURNED = 0.15

NOT_WRAPPED = WORDS.mistake('go_to/not-wrapped')
FULL_TURN = WORDS.mistake('go_to/from-0-to-2-pi')
WRONG_SIGN = WORDS.mistake('go_to/wrong-sign')
EXCHANGED = WORDS.mistake('go_to/exchanged')
MIXED = WORDS.mistake('go_to/mixed')
HALF = WORDS.mistake('go_to/half-heading')
TOO_EARLY = WORDS.mistake('go_to/too-early')
DRIVES_ON = WORDS.mistake('go_to/drives-on')
ASTRAY = WORDS.mistake('go_to/astray')


def _turns(drive: Drive) -> None:
    goal, start = drive.goals[0], drive.start
    bearing = math.atan2(goal[1] - start.y, goal[0] - start.x)
    error = wrap_angle(bearing - start.yaw)
    turns = [wrap_angle(pose.yaw - start.yaw) for _, pose in drive.poses]
    first = next((turn for turn in turns if abs(turn) > TURNED), 0.0)
    if first * error >= 0:
        return
    expected = (
        f'it turns by {error:.2f} rad, from its heading {start.yaw:.2f} rad to the direction of '
        f'the goal, {bearing:.2f} rad'
    )
    difference = bearing - start.yaw
    if _is_wrapped_to_full_turn(drive, goal):
        mistake = FULL_TURN.of(error=error)
        raise Fail(expected, 'it turns to the left, the long way round', mistake)
    if abs(difference) > math.pi:
        told = {'bearing': bearing, 'yaw': start.yaw, 'difference': difference}
        mistake = NOT_WRAPPED.of(**{name: f'{angle:.2f}' for name, angle in told.items()})
        raise Fail(expected, 'it turns the other way, the long way round', mistake)
    side = 'left' if first > 0 else 'right'
    raise Fail(
        expected,
        f'it turns to the {side}, away from the goal',
        _why_away(drive, goal) or ASTRAY,
    )


# What may be taken for the angle that is still to be turned, from the direction of the goal and
# the heading, rad. The first one is right.
_ERRORS: Sequence[tuple[Mistake | None, Callable[[float, float], float]]] = (
    (None, lambda bearing, yaw: bearing - yaw),
    (EXCHANGED, lambda bearing, yaw: math.pi / 2 - bearing - yaw),
    (WRONG_SIGN, lambda bearing, yaw: yaw - bearing),
    (HALF, lambda bearing, yaw: bearing - yaw / 2),
    (MIXED, lambda bearing, yaw: bearing - math.degrees(yaw)),
    (MIXED, lambda bearing, yaw: math.degrees(bearing) - yaw),
    (MIXED, lambda bearing, yaw: math.degrees(bearing - yaw)),
)


def _is_wrapped_to_full_turn(drive: Drive, goal: Point) -> bool:
    """Tell whether each command is in proportion to an angle from 0 to 2 * pi."""
    ratios = []
    for command in drive.moving:
        pose = drive.seen(command.at)[-1]
        angle = (math.atan2(goal[1] - pose.y, goal[0] - pose.x) - pose.yaw) % math.tau
        if angle > TURNED:
            ratios.append(command.w / angle)
    mean = statistics.fmean(ratios) if ratios else 0.0
    return len(ratios) > 3 and mean > 0 and statistics.pstdev(ratios) < 0.05 * mean


def _why_away(drive: Drive, goal: Point) -> Mistake | None:
    """Return why it turns the wrong way, if each of its commands tells the same.

    Of several angles that turn to the same side, it is the one to which the commands are in
    proportion, most nearly.
    """

    def taken(command: Command, error: Callable[[float, float], float]) -> list[float]:
        # The newest one may come at the same moment as the timer.
        return [
            wrap_angle(error(math.atan2(goal[1] - pose.y, goal[0] - pose.x), pose.yaw))
            for pose in drive.seen(command.at, since=STEP_SEC)[-2:]
        ]

    def fits(error: Callable[[float, float], float]) -> bool:
        return all(
            any(command.w * angle >= 0 for angle in taken(command, error))
            for command in drive.moving
        )

    def spread(error: Callable[[float, float], float]) -> float:
        pairs = [(command.w, taken(command, error)[-1]) for command in drive.moving]
        ratios = [w / angle for w, angle in pairs if angle]
        if not ratios:
            return math.inf
        return statistics.pstdev(ratios) / abs(statistics.fmean(ratios) or math.inf)

    found = [(spread(error), mistake) for mistake, error in _ERRORS if fits(error)]
    return min(found, key=lambda each: each[0])[1] if found else None


def _arrives(drive: Drive) -> None:
    goal, end = drive.goals[0], drive.end
    away = math.dist(end[:2], goal)
    turned = sum(
        abs(wrap_angle(after.yaw - before.yaw))
        for (_, before), (_, after) in pairwise(drive.poses)
    )
    try:
        look_at_time(drive, SECONDS)
    except Fail as fail:
        near = any(math.dist(pose[:2], goal) <= NEAR for _, pose in drive.poses)
        mistake = DRIVES_ON if near else _why_away(drive, goal)
        # It was quick enough, and went elsewhere.
        quick = drive.way() >= math.dist(drive.start[:2], goal) or turned >= math.tau
        if mistake is None and not quick:
            raise
        raise Fail(fail.expected, f'{fail.seen}, {away:.2f} m away', mistake or ASTRAY) from None
    if not drive.ending or away <= NEAR + BRAKING:
        return
    raise Fail(
        f'it stands at x = {goal[0]:.2f} m, y = {goal[1]:.2f} m, up to {NEAR} m off',
        f'it came to x = {end.x:.2f} m, y = {end.y:.2f} m after {drive.duration:.1f} s, '
        f'{away:.2f} m away',
        TOO_EARLY if away < 4 * NEAR else ASTRAY,
    )


def _draw() -> list[Trial]:
    """Return drives: to a side, across the jump of the angle in both ways, to the other side.

    The first one leads along y, so that x alone tells nothing of it; those in the middle along x.
    How many more there are, to anywhere, is drawn, too.

    The shorter way leads from pi to -pi in one of them, and from -pi to pi in another.
    """
    uniform, side = random.uniform, random.choice((-1, 1))
    turn, aside = uniform(0.5, 1.2), uniform(0.6, 1.4)
    return [
        _trial(side * (uniform(1.4, 1.75) - aside), side * aside),
        _trial(side * (math.pi - turn / 2), side * turn),
        _trial(-side * (math.pi - turn / 2), -side * turn),
        _trial(uniform(-0.6, 0.6), -side * uniform(0.6, 1.4)),
        *(_trial(uniform(-3, 3), uniform(-3, 3)) for _ in range(random.randint(1, 2))),
    ]


def _trial(yaw: float, turn: float) -> Trial:
    # Nothing stands within a metre of the origin, and the way leads past it.
    way = random.uniform(*WAY)
    x = random.uniform(-0.2, 0.2) - way / 2 * math.cos(yaw + turn)
    y = random.uniform(-0.2, 0.2) - way / 2 * math.sin(yaw + turn)
    goal: Point = x + way * math.cos(yaw + turn), y + way * math.sin(yaw + turn)
    fields = {'x': goal[0], 'y': goal[1], 'theta': random.uniform(-3, 3)}
    return Trial((x, y, yaw), fields, goals=[goal])


def _tell(drives: Sequence[Drive]) -> str:
    away = [math.dist(drive.end[:2], drive.goals[0]) for drive in drives]
    return f'It came to {", ".join(f"{d:.2f} m" for d in away)} from its goals, and stands.'


exercise = Exercise(
    words=WORDS,
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    clauses=(
        Begins(*SIGN),
        Hears('/odom', ODOMETRY, SIGN[0]),
        SENSIBLE,
        Asked(WORDS.clause('turns'), _turns),
        Asked(RATE, look_at_rate),
        Asked(
            WORDS.of(seconds=f'{SECONDS:.0f}').clause('arrives'),
            _arrives,
        ),
        Asked(
            WORDS.clause('partial'),
            partial(look_at_end, may_pause=True),
        ),
    ),
    stage=Drives(SIGN, _draw, _tell, seconds=SECONDS),
)
