"""Exercise: hold a straight line on ice, by feedback."""

from __future__ import annotations

import math
import random
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from labkit.exercises import Exercise, Fail, Mistake, words_of
from labkit.exercises.clauses import Asked
from labkit.exercises.figures import figure
from labkit.lessons.turtlebot.drive import EMPTY, SAME, Drive, Trial
from labkit.lessons.turtlebot.drive_clauses import (
    RATE,
    SENSIBLE,
    STOPS,
    Begins,
    Hears,
    look_at_numbers,
    look_at_rate,
)
from labkit.lessons.turtlebot.stage import Drives
from labkit.sim.kinematics import Pose, wrap_angle
from labkit.sim.physics.things import Ice
from labkit.sim.world import open_field

if TYPE_CHECKING:
    from labkit.sim.physics.mujoco_world import PhysicsWorld

__all__ = ['exercise', 'make_ice']

WORDS = words_of(__file__)

SIGN = ('/go_straight', EMPTY)
IMU, TRUTH = 'sensor_msgs/msg/Imu', '/base_pose_ground_truth'
# How fast it drives, m/s, for how long, and how much longer or shorter, s.
SPEED, SECONDS, EITHER = 0.2, 10.0, 0.5
# How far it may come off its line, m.
NEAR = 0.25
# How far it has to come along its line, m: its wheels slip, so it comes less far than they turn.
FAR = 0.5
# Friction on the slippery side and on the other one.
SLIPPERY, LESS = (0.04, 0.06), (0.08, 0.15)
# Commands are in proportion to an error if less than this share of their squares is left over.
FITS = 0.3
# Half of the size of the ice, m.
HALF = 6.0

OTHER_SPEED = WORDS.mistake('ice/other-speed')
TOO_LONG = WORDS.mistake('ice/too-long')
TOO_SHORT = WORDS.mistake('ice/too-short')
OMNISCIENT = WORDS.mistake('ice/omniscient')
BLIND = WORDS.mistake('ice/blind')
WRONG_SIGN = WORDS.mistake('ice/wrong-sign')
BY_WHEELS = WORDS.mistake('ice/by-wheels')
EAST = WORDS.mistake('ice/east')
NOT_WRAPPED = WORDS.mistake('ice/not-wrapped')
KEPT = WORDS.mistake('ice/kept')
WEAK = WORDS.mistake('ice/weak')
ASTRAY = WORDS.mistake('ice/astray')

# The heading at the start of the first drive of this check, rad.
_first: list[float] = []


def make_ice(yaw: float, left: float, right: float) -> PhysicsWorld:
    """Return a field of ice that is not as slippery everywhere.

    Args:
        yaw: A line through the origin with this heading parts it, a multiple of pi / 2.
        left: Friction to the left of the line.
        right: Friction to the right.
    """
    from labkit.sim.physics.mujoco_world import PhysicsWorld

    across = (-math.sin(yaw), math.cos(yaw))
    ice = []
    for side, friction in ((1, left), (-1, right)):
        x, y = (round(side * part) * HALF for part in across)
        width, height = (HALF if part else 2 * HALF for part in (x, y))
        ice.append(Ice(x / 2, y / 2, width, height, friction))
    return PhysicsWorld(open_field(), ice=ice)


def _does_not_peep(drive: Drive) -> None:
    evidence = drive.evidence
    name = evidence.subscription(SIGN[0]).node
    if any(end.node == name for end in evidence.probe.subscriptions(TRUTH)):
        raise Fail(f'no subscription to {TRUTH}', f'{name} subscribes to it', OMNISCIENT)


def _speed(drive: Drive) -> None:
    for command in drive.moving:
        if abs(command.v - SPEED) > SAME:
            raise Fail(
                f'linear.x = {SPEED} m/s in each command', f'a command with {command}', OTHER_SPEED
            )
    taken = drive.moving[-1].at - drive.sign if drive.moving else 0.0
    if abs(taken - SECONDS) > EITHER + drive.margin:
        expected = f'commands that drive for {SECONDS:.0f} s (up to {EITHER} s more or less)'
        mistake = TOO_LONG if taken > SECONDS else TOO_SHORT
        raise Fail(expected, f'they drive for {taken:.1f} s', mistake)


def _off(drive: Drive) -> float:
    """Return how far it comes off its line, m."""
    return max((drive.told(pose).y for _, pose in drive.came), key=abs)


def _line(drive: Drive) -> None:
    off, way = _off(drive), drive.told(drive.end).x
    if abs(off) <= NEAR and way >= FAR:
        return
    side = 'left' if off > 0 else 'right'
    raise Fail(
        f'it stays on the line ahead of its start, up to {NEAR} m off, and comes {FAR} m far',
        f'it came {abs(off):.2f} m to the {side}, and {way:.2f} m ahead; its heading is '
        f'{math.degrees(drive.told(drive.end).yaw):.0f} degrees off in the end',
        _why(drive),
    )


@dataclass(frozen=True)
class _Moment:
    """What may be taken for the error of the heading at a command, from these headings, rad."""

    start: float
    yaw: float
    believed: float
    first: float


_ERRORS: Sequence[tuple[Mistake, Callable[[_Moment], float]]] = (
    (WEAK, lambda at: wrap_angle(at.start - at.yaw)),
    (WRONG_SIGN, lambda at: wrap_angle(at.yaw - at.start)),
    (BY_WHEELS, lambda at: wrap_angle(at.start - at.believed)),
    (EAST, lambda at: wrap_angle(-at.yaw)),
    (NOT_WRAPPED, lambda at: at.start - at.yaw),
    (KEPT, lambda at: wrap_angle(at.first - at.yaw)),
)


def _why(drive: Drive) -> Mistake:
    """Return why it leaves its line: the error to which its commands are in proportion."""
    if not any(command.w for command in drive.moving):
        return BLIND
    moments = [
        (
            command.w,
            _Moment(
                drive.start.yaw,
                _newest(drive.true_poses, command.at).yaw,
                _newest(drive.poses, command.at).yaw,
                _first[0],
            ),
        )
        for command in drive.moving
    ]
    found = []
    for mistake, error in _ERRORS:
        pairs = [(w, error(moment)) for w, moment in moments]
        squares = sum(angle * angle for _, angle in pairs)
        gain = sum(w * angle for w, angle in pairs) / squares if squares else 0.0
        rest = sum((w - gain * angle) ** 2 for w, angle in pairs)
        if gain > 0:
            found.append((rest / sum(w * w for w, _ in pairs), mistake))
    rest, mistake = min(found, key=lambda each: each[0], default=(1.0, ASTRAY))
    if mistake is WEAK:
        look_at_numbers(drive)  # of degrees it is not too little
    return mistake if rest < FITS else ASTRAY


def _newest(poses: Sequence[tuple[float, Pose]], at: float) -> Pose:
    # One may come at the same moment as the timer, and after it.
    index = bisect_right(poses, at - SAME, key=lambda pair: pair[0])
    return poses[max(index - 1, 0)][1]


def _draw() -> list[Trial]:
    """Return drives in three directions, to one side first and then to the other.

    One of them leads along -x, where the heading jumps from pi to -pi as the robot begins to turn.
    """
    side = random.choice((-1, 1))
    yaws = [math.pi / 2, side * (math.pi - 0.01), -math.pi / 2]
    if side < 0:
        yaws.reverse()
    _first[:] = yaws[:1]
    return [_trial(yaw, side * (-1) ** number) for number, yaw in enumerate(yaws, start=1)]


def _trial(yaw: float, side: int) -> Trial:
    """Return a drive in which the robot would turn to a side: 1 is left."""
    frictions = [random.uniform(*SLIPPERY), random.uniform(*LESS)][::side]
    along = random.uniform(-1.0, 0.0)
    axis = round(yaw / (math.pi / 2)) * math.pi / 2
    return Trial(
        (along * round(math.cos(axis)), along * round(math.sin(axis)), yaw),
        goals=[(SPEED * SECONDS, 0.0)],
        from_start=True,
        make_world=partial(make_ice, axis, *frictions),
        drift=random.choice((-1, 1)) * random.uniform(0.01, 0.03),
    )


def _tell(drives: Sequence[Drive]) -> str:
    off = ', '.join(f'{abs(_off(drive)):.2f} m' for drive in drives)
    return f'On ice it stays on its lines, at most {off} off.'


exercise = Exercise(
    words=WORDS,
    shared=['/cmd_vel'],
    reliable=['/cmd_vel'],
    clauses=(
        Begins(*SIGN),
        Hears('/imu', IMU, SIGN[0]),
        Asked(WORDS.of(topic=TRUTH).clause('peep'), _does_not_peep),
        Asked(RATE, look_at_rate),
        Asked(WORDS.of(speed=SPEED, seconds=figure(SECONDS)).clause('speed'), _speed),
        Asked(WORDS.of(near=NEAR, far=FAR).clause('line'), _line),
        SENSIBLE,
        STOPS,
    ),
    stage=Drives(SIGN, _draw, _tell, seconds=SECONDS + 1.0, physics=True),
)
