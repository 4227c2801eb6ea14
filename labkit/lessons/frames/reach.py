"""Exercise: drive to a point that is given in a frame of the robot."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from functools import partial
from itertools import pairwise

from labkit.exercises import Exercise, Fail, Mistake, words_of
from labkit.exercises.clauses import Asked
from labkit.lessons.frames.places import Place, on_floor
from labkit.lessons.turtlebot.drive import Drive, Point, Trial
from labkit.lessons.turtlebot.drive_clauses import (
    RATE,
    SENSIBLE,
    Begins,
    look_at_end,
    look_at_rate,
    look_at_time,
)
from labkit.lessons.turtlebot.stage import Drives
from labkit.sim.kinematics import wrap_angle
from labkit.transforms.rotations import Vector

__all__ = ['exercise']

WORDS = words_of(__file__)

SIGN = ('/target', 'geometry_msgs/msg/PointStamped')
# How near it has to come, and how much further off it may stand after braking, m.
NEAR, BRAKING = 0.05, 0.02
SECONDS = 14.0
# Targets are so far away, m.
WAY = (0.5, 0.9)
# One that stays where it is comes first: so what comes of the others has to do with that they
# move.
FRAMES = ('odom', 'base_link', 'camera_rgb_optical_frame', 'base_scan')
_POINT = ('point.x', 'point.y', 'point.z')

RUNS_AWAY = WORDS.mistake('reach/runs-away')
AXES = WORDS.mistake('reach/axes')
IN_ODOM = WORDS.mistake('reach/in-odom')
TOO_EARLY = WORDS.mistake('reach/too-early')
DRIVES_ON = WORDS.mistake('reach/drives-on')
ASTRAY = WORDS.mistake('reach/astray')

# The frame in which each goal of this check was given, and the point there.
_targets: dict[Point, tuple[str, Vector]] = {}


def _arrives(drive: Drive) -> None:
    goal, end = drive.goals[0], drive.end
    frame, (x, y, z) = _targets[goal]
    away = math.dist(end[:2], goal)
    expected = (
        f'the point x = {x:.2f} m, y = {y:.2f} m, z = {z:.2f} m of {frame}, which is '
        f'x = {goal[0]:.2f} m, y = {goal[1]:.2f} m in odom'
    )
    came = f'x = {end.x:.2f} m, y = {end.y:.2f} m, {away:.2f} m away'
    try:
        look_at_time(drive, SECONDS)
    except Fail as fail:
        near = any(math.dist(pose[:2], goal) <= NEAR for _, pose in drive.poses)
        turned = sum(abs(wrap_angle(b.yaw - a.yaw)) for (_, a), (_, b) in pairwise(drive.poses))
        if not near and drive.way() < math.dist(drive.start[:2], goal) and turned < math.tau:
            raise
        mistake = DRIVES_ON if near else ASTRAY if frame == 'odom' else RUNS_AWAY
        raise Fail(expected, f'{fail.seen}, at {came}', _why(drive) or mistake) from None
    if not drive.ending or away <= NEAR + BRAKING:
        return
    near_by = TOO_EARLY if away < 4 * NEAR else ASTRAY
    raise Fail(expected, f'it stands at {came}', _why(drive) or near_by)


def _why(drive: Drive) -> Mistake | None:
    """Return the reason that the place tells at which it stands."""
    _, point = _targets[drive.goals[0]]
    start = on_floor(*drive.start)
    wrongs = ((AXES, start.has(point)), (IN_ODOM, point))
    for mistake, wrong in wrongs:
        apart = math.dist(wrong[:2], drive.goals[0]) > 4 * NEAR
        if apart and math.dist(drive.end[:2], wrong[:2]) <= NEAR + BRAKING:
            return mistake
    return None


def _draw() -> list[Trial]:
    """Return a drive for each frame, to either side."""
    _targets.clear()
    side = random.choice((-1, 1))
    return [
        _trial(frame, side * (-1) ** number * random.uniform(0.4, 1.3))
        for number, frame in enumerate(FRAMES)
    ]


def _trial(frame: str, turn: float) -> Trial:
    # Nothing stands within a metre of the origin, and the way leads past it. The robot does not
    # look along x, so that odom and the frames of the robot differ.
    way, yaw = random.uniform(*WAY), random.choice((-1, 1)) * random.uniform(0.7, 2.4)
    x = random.uniform(-0.2, 0.2) - way / 2 * math.cos(yaw + turn)
    y = random.uniform(-0.2, 0.2) - way / 2 * math.sin(yaw + turn)
    goal: Point = x + way * math.cos(yaw + turn), y + way * math.sin(yaw + turn)
    robot = on_floor(x, y, yaw)
    seen_from = Place((0.0, 0.0, 0.0)) if frame == 'odom' else robot.then(_part(frame))
    point = seen_from.back.has((*goal, random.uniform(0.0, 0.3)))
    _targets[goal] = frame, point
    fields = {'header.frame_id': frame, **dict(zip(_POINT, point, strict=True))}
    return Trial((x, y, yaw), fields, goals=[goal])


def _part(frame: str) -> Place:
    """Return where a part of the robot is, seen from the floor below it."""
    from builtin_interfaces.msg import Time

    from labkit.sim.parts import static_parts

    parts = {each.child_frame_id: each for each in static_parts(Time())}
    place = Place((0.0, 0.0, 0.0))
    while frame in parts:
        place = Place.of(parts[frame].transform).then(place)
        frame = parts[frame].header.frame_id
    return place


def _tell(drives: Sequence[Drive]) -> str:
    away = [math.dist(drive.end[:2], drive.goals[0]) for drive in drives]
    told = ', '.join(f'{d:.2f} m ({frame})' for d, frame in zip(away, FRAMES, strict=False))
    return f'It came near to its targets: {told}.'


exercise = Exercise(
    words=WORDS,
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    clauses=(
        Begins(*SIGN),
        SENSIBLE,
        Asked(RATE, look_at_rate),
        Asked(
            WORDS.of(seconds=f'{SECONDS:.0f}', near=NEAR, braking=BRAKING).clause('arrives'),
            _arrives,
        ),
        Asked(WORDS.clause('ends'), partial(look_at_end, may_pause=True)),
    ),
    stage=Drives(SIGN, _draw, _tell, seconds=SECONDS),
)
