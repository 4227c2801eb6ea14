"""Exercise: push a crate into a corner, in a world with physics."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from labkit.exercises import Exercise, Fail, Mistake, words_of
from labkit.exercises.clauses import Asked
from labkit.lessons.turtlebot.drive import Drive, Point, Trial
from labkit.lessons.turtlebot.drive_clauses import SENSIBLE, Begins, look_at_end, look_at_time
from labkit.lessons.turtlebot.stage import Drives
from labkit.sim.kinematics import wrap_angle
from labkit.sim.physics.things import Crate
from labkit.sim.world import room

if TYPE_CHECKING:
    from labkit.sim.physics.mujoco_world import PhysicsWorld

__all__ = ['exercise', 'make_yard']

WORDS = words_of(__file__)

SIGN = ('/crate', 'geometry_msgs/msg/Pose2D')
# The room is so wide, m: its walls meet in the corner.
WIDTH = 3.0
CORNER: Point = (WIDTH / 2, WIDTH / 2)
# How far the middle of the crate may be from both walls, m. It is 0.1 m if it touches them.
NEAR = 0.25
SECONDS = 60.0
# A crate that has moved by less than this was not touched, m; one that has moved by so much
# against the way to the corner was pushed away; one that has turned by so much, rad, was not
# pushed in its middle.
TOUCHED, AWAY, TURNED = 0.02, 0.1, 0.35
# From the middle of the robot to that of a crate that it could just touch, m.
REACH = 0.3

MISSED = WORDS.mistake('corner/missed')
EXCHANGED = WORDS.mistake('corner/exchanged')
KEPT = WORDS.mistake('corner/kept')
PUSHED_AWAY = WORDS.mistake('corner/away')
ONE_WALL = WORDS.mistake('corner/one-wall')
SLANTED = WORDS.mistake('corner/slanted')
PASSED = WORDS.mistake('corner/passed')
TOO_SHORT = WORDS.mistake('corner/too-short')


def make_yard(x: float, y: float) -> PhysicsWorld:
    """Return a room with a crate, as the check has it.

    Args:
        x: Where the crate is, m.
        y: Where the crate is, m.
    """
    from labkit.sim.physics.mujoco_world import PhysicsWorld

    return PhysicsWorld(room(WIDTH, WIDTH), crates=[Crate(x, y)])


def _gaps(drive: Drive) -> tuple[float, float]:
    """Return how far the crate is from the two walls in the end, m."""
    crate = drive.crate[-1][1]
    return CORNER[0] - crate.x, CORNER[1] - crate.y


def _in_corner(drive: Drive) -> None:
    if max(_gaps(drive)) <= NEAR:
        look_at_time(drive, SECONDS)
        return
    begin, end = drive.crate[0][1], drive.crate[-1][1]
    mistake = _why(drive)
    if mistake in (ONE_WALL, TOO_SHORT):
        # It may still be on its way.
        look_at_time(drive, SECONDS)
    late = f' after {drive.duration:.0f} s' if drive.cut else ''
    raise Fail(
        f'the crate from ({begin.x:.2f}, {begin.y:.2f}) m is in the corner, its middle up to '
        f'{NEAR} m from both walls',
        f'it is at ({end.x:.2f}, {end.y:.2f}) m{late}: {_gaps(drive)[0]:.2f} m from one wall, '
        f'{_gaps(drive)[1]:.2f} m from the other',
        mistake,
    )


def _why(drive: Drive) -> Mistake:
    """Return why the crate is not in the corner, by how it came and where the robot went."""
    begin, end = drive.crate[0][1], drive.crate[-1][1]
    path = [pose[:2] for _, pose in drive.came]
    if max(math.dist(begin[:2], pose[:2]) for _, pose in drive.crate) < TOUCHED:
        if drive.number:
            return KEPT
        # A robot that takes x for y goes to where the crate would be then.
        mirrored = (begin.y, begin.x)
        near = min(math.dist(point, mirrored) for point in path)
        return EXCHANGED if near < REACH else MISSED
    gap_x, gap_y = _gaps(drive)
    turned = max(abs(wrap_angle(pose.yaw - begin.yaw)) for _, pose in drive.crate)
    if turned > TURNED:
        return SLANTED.of(degrees=round(math.degrees(turned)))
    if end.x < begin.x - AWAY or end.y < begin.y - AWAY:
        return PUSHED_AWAY
    if min(gap_x, gap_y) <= NEAR:
        other = end.y - begin.y if gap_x < gap_y else end.x - begin.x
        if other < AWAY:
            return ONE_WALL
    robot = drive.end
    passed = robot.x > end.x if gap_x > gap_y else robot.y > end.y
    return PASSED if passed else TOO_SHORT


def _draw() -> list[Trial]:
    """Return drives with crates in two bands across the room, so that no two are in a row.

    x and y of a crate are not alike. The robot begins on the side away from the corner.
    """
    bands = [(-0.3, 0.0, 0.4, 0.6), (0.4, 0.6, -0.3, 0.0)]
    random.shuffle(bands)
    return [_trial(*band) for band in bands]


def _trial(left: float, right: float, low: float, high: float) -> Trial:
    uniform = random.uniform
    x, y = uniform(left, right), uniform(low, high)
    return Trial(
        (uniform(-1.1, -0.9), uniform(-1.1, -0.9), uniform(-3, 3)),
        {'x': x, 'y': y, 'theta': 0.0},
        goals=[CORNER],
        make_world=partial(make_yard, x, y),
    )


def _tell(drives: Sequence[Drive]) -> str:
    told = ' and '.join(f'{max(_gaps(drive)):.2f} m' for drive in drives)
    return f'The crates are in the corner: {told} from its walls, at most.'


exercise = Exercise(
    words=WORDS,
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    clauses=(
        Begins(*SIGN),
        SENSIBLE,
        Asked(
            WORDS.of(x=CORNER[0], y=CORNER[1], near=NEAR, seconds=f'{SECONDS:.0f}').clause(
                'corner'
            ),
            _in_corner,
        ),
        Asked(WORDS.clause('ends'), partial(look_at_end, may_pause=True)),
    ),
    stage=Drives(SIGN, _draw, _tell, seconds=SECONDS, physics=True),
)
