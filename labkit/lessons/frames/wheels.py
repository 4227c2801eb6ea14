"""Exercise: odometry from the turns of the wheels, as the driver of a robot computes it."""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, NamedTuple

from labkit.exercises import Exercise, Fail, Mistake, expect, words_of
from labkit.exercises.clauses import WITHIN, Evidence, GraphClause
from labkit.exercises.clauses.base import Test
from labkit.exercises.figures import figure, many
from labkit.exercises.messages_heard import Lived
from labkit.exercises.what_is_asked import PUBLISHER, SUBSCRIPTION, Role
from labkit.lessons.frames.places import TF, Place, metres
from labkit.sim.kinematics import Motion, Pose, Twist2, wrap_angle, yaw_from_quaternion
from labkit.sim.robots import BURGER

__all__ = ['exercise']

WORDS = words_of(__file__)

JOINTS, ODOMETRY = 'sensor_msgs/msg/JointState', 'nav_msgs/msg/Odometry'
HEARS, SAYS, TF_TOPIC = '/joint_states', '/odom', '/tf'
ODOM, BASE = 'odom', 'base_footprint'
WHEELS = 'wheel_left_joint', 'wheel_right_joint'
ROBOT = '/turtlebot'
RADIUS, SEPARATION = BURGER.wheel_radius, BURGER.wheel_separation
WITHIN_SEC = 1.0
# So many steps are driven. From one to the next the robot goes so far, m, turns by so much, rad,
# and so much time passes, s: a robot at 20 Hz or so.
STEPS = 24
WAY, TURN, STEP_SEC = (0.008, 0.02), (0.02, 0.08), (0.04, 0.06)
# What a learner may round, m and rad.
SAME_M, SAME_RAD = 1e-5, 1e-4
# A length of a quaternion that is off by less is 1.
LENGTH = 1e-3
SECOND = 10**9

ROBOT_TELLS = WORDS.mistake('wheels/robot-tells')
NOTHING = WORDS.mistake('wheels/nothing')
SOME = WORDS.mistake('wheels/some')
SEVERAL = WORDS.mistake('wheels/several')
LENGTH_OFF = WORDS.mistake('wheels/length')
ELSEWHERE = WORDS.mistake('wheels/elsewhere')
FRAMES_SWAPPED = WORDS.mistake('wheels/frames-swapped')
FRAMES = WORDS.mistake('wheels/frames')
NO_STAMP = WORDS.mistake('wheels/stamp-0')
STAMP = WORDS.mistake('wheels/stamp')
NO_TRANSFORM = WORDS.mistake('wheels/no-transform')
TRANSFORM_FRAMES = WORDS.mistake('wheels/transform-frames')
TRANSFORM_BACK = WORDS.mistake('wheels/transform-back')
TRANSFORM = WORDS.mistake('wheels/transform')
TRANSFORM_STAMP = WORDS.mistake('wheels/transform-stamp')


class _Reading(NamedTuple):
    """A message of the wheels: its stamp, ns, the angles, rad, and which wheel comes first."""

    stamp: int
    left: float
    right: float
    right_first: bool

    def fields(self, before: _Reading | None) -> dict[str, object]:
        """Return the fields of the message that comes after another one."""
        sec, nanosec = divmod(self.stamp, SECOND)
        rates = [0.0, 0.0]
        if before is not None:
            passed = (self.stamp - before.stamp) / SECOND
            rates = [(self.left - before.left) / passed, (self.right - before.right) / passed]
        order = -1 if self.right_first else 1
        return {
            'header.stamp.sec': sec,
            'header.stamp.nanosec': nanosec,
            'header.frame_id': 'base_link',
            'name': list(WHEELS)[::order],
            'position': [self.left, self.right][::order],
            'velocity': rates[::order],
        }

    @property
    def in_order(self) -> tuple[float, float]:
        """The angles as they stand in the message."""
        return (self.right, self.left) if self.right_first else (self.left, self.right)


class _Roll(NamedTuple):
    """How the robot has moved: its way, m, and its turn, rad."""

    way: float
    turn: float

    @staticmethod
    def of(left: float, right: float) -> _Roll:
        """Return that of wheels which turn by angles, rad."""
        return _Roll(RADIUS * (left + right) / 2, RADIUS * (right - left) / SEPARATION)

    def then(self, pose: Pose, ways: float = 1.0, turns: float = 1.0) -> Pose:
        """Return where it is after that, on an arc; the way and the turn may be so many times."""
        return Motion(pose, Twist2(self.way * ways, self.turn * turns)).pose_at(1.0)

    @property
    def unsure(self) -> float:
        """How far off a sum is that goes straight ahead along any heading between the two, m.

        A step of length s on an arc that turns by a ends at the integral of s exp(i a t) for t
        from 0 to 1. That is off s by no more than the integral of |s a t|, which is |s a| / 2.
        """
        return abs(self.way * self.turn) / 2


def _rolled(before: _Reading, now: _Reading) -> _Roll:
    return _Roll.of(now.left - before.left, now.right - before.right)


def _as_in_message(before: _Reading, now: _Reading) -> _Roll:
    a, b = zip(before.in_order, now.in_order, strict=True)
    return _Roll.of(a[1] - a[0], b[1] - b[0])


def _along_x(pose: Pose, before: _Reading, now: _Reading, turns: float) -> Pose:
    way, turn = _rolled(before, now)
    return Pose(pose.x + way, pose.y, wrap_angle(pose.yaw + turns * turn))


# Where a program with a mistake says the robot is, from where it has said before.
_Model = Callable[[Pose, _Reading, _Reading], Pose]
_MODELS: Sequence[tuple[Mistake, _Model]] = (
    (WORDS.mistake('wheels/order'), lambda p, a, b: _as_in_message(a, b).then(p)),
    (WORDS.mistake('wheels/swapped'), lambda p, a, b: _rolled(a, b).then(p, turns=-1)),
    (WORDS.mistake('wheels/diameter'), lambda p, a, b: _rolled(a, b).then(p, 2, 2)),
    (WORDS.mistake('wheels/half-separation'), lambda p, a, b: _rolled(a, b).then(p, turns=2)),
    (WORDS.mistake('wheels/half-turn'), lambda p, a, b: _rolled(a, b).then(p, turns=0.5)),
    (WORDS.mistake('wheels/sum'), lambda p, a, b: _rolled(a, b).then(p, ways=2)),
    (WORDS.mistake('wheels/whole-angles'), lambda p, a, b: _Roll.of(b.left, b.right).then(p)),
    (WORDS.mistake('wheels/forgets'), lambda p, a, b: _rolled(a, b).then(Pose())),
    (WORDS.mistake('wheels/only-x'), lambda p, a, b: _along_x(p, a, b, 1.0)),
    (WORDS.mistake('wheels/only-x'), lambda p, a, b: _along_x(p, a, b, 0.0)),
)
# The way is right, and what the orientation says of a turn is so many times as much.
_TURNS: Sequence[tuple[Mistake, float]] = (
    (WORDS.mistake('wheels/not-turned'), 0.0),
    (WORDS.mistake('wheels/whole-angle'), 2.0),
)


@dataclass(frozen=True)
class _Answers(GraphClause):
    """Each message of the wheels leads to one of odometry."""

    text = WORDS.of(within=WITHIN).clause('answers')
    readings: list[_Reading] = field(default_factory=list, compare=False)
    # The robot of the lesson tells of its wheels, too.
    still = (ROBOT,)

    @property
    def roles(self) -> dict[Role, str]:
        return {(SUBSCRIPTION, HEARS): JOINTS, (PUBLISHER, SAYS): ODOMETRY}

    @property
    def listens(self) -> Collection[str]:
        return (SAYS,)

    def find(self, evidence: Evidence) -> None:
        from labkit.rosgraph.endpoints import publishers

        node = evidence.publisher(SAYS).node
        evidence.subscription(HEARS, node)
        if ROBOT in {end.node for end in publishers(evidence.probe.node, SAYS)}:
            raise Fail(f'{node} alone on {SAYS}', f'{ROBOT} publishes there, too', ROBOT_TELLS)

    def tests(self, evidence: Evidence) -> Sequence[Test]:
        end = evidence.publisher(SAYS)
        expect.spun(evidence.probe, end)
        # The clocks of this process may be ahead: what is older than the robot's own messages, tf2
        # leaves out.
        node = evidence.probe.node_object(end.node)
        now = time.time_ns() if node is None else node.get_clock().now().nanoseconds
        self.readings[:] = _draw(now)
        # To the first one nothing can be said yet by a node that has heard nothing before.
        return [
            Test(HEARS, JOINTS, now.fields(before), (SAYS,), due=min(number, 1))
            for number, (before, now) in enumerate(
                zip((None, *self.readings), self.readings, strict=False)
            )
        ]

    def judge(self, evidence: Evidence) -> str:
        sent = [each.at for each in evidence.tests.get(self, ())]
        said = _said(evidence)
        expected = f'a message on {SAYS} for each one on {HEARS}'
        if not said:
            raise Fail(expected, f'nothing for {many(len(sent), "message")}', NOTHING)
        seen = f'{len(said)} for {len(sent)}'
        if len(said) > len(sent):
            raise Fail(expected, seen, SEVERAL)
        if len(said) < len(sent) - 1:
            raise Fail(expected, seen, SOME)
        for at, sample in zip(reversed(sent), reversed(said), strict=False):
            late = sample.at - at
            if not -evidence.life.step <= late <= WITHIN_SEC + evidence.life.step:
                raise Fail(f'{expected}, {WITHIN}', f'one after {figure(late)} s', SOME)
        return ''


ANSWERS = _Answers()


def _said(evidence: Evidence) -> list[Lived]:
    """Return what the node has said about where the robot is."""
    return [s for s in evidence.life.on(SAYS) if s.node != ROBOT]


def _pairs(evidence: Evidence) -> list[tuple[_Reading, Any]]:
    """Return the readings, from the second one on, with what was said of each."""
    messages = [sample.message for sample in _said(evidence)]
    return list(zip(ANSWERS.readings[1:], messages[1 - len(ANSWERS.readings) :], strict=True))


def _pose(message: Any) -> Pose:
    at, turn = message.pose.pose.position, message.pose.pose.orientation
    return Pose(at.x, at.y, yaw_from_quaternion(turn.x, turn.y, turn.z, turn.w))


def _in_words(pose: Pose) -> str:
    return f'x = {pose.x:.4f} m, y = {pose.y:.4f} m, yaw = {pose.yaw:.4f} rad'


@dataclass(frozen=True)
class _Pose(GraphClause):
    """It says where the robot is."""

    text = WORDS.of(base=BASE, odom=ODOM).clause('pose')

    def judge(self, evidence: Evidence) -> str:
        pairs = _pairs(evidence)
        for _, message in pairs:
            turn = message.pose.pose.orientation
            length = math.hypot(turn.x, turn.y, turn.z, turn.w)
            if not abs(length - 1) <= LENGTH:
                seen = f'z = {figure(turn.z)}, w = {figure(turn.w)}, of length {figure(length)}'
                raise Fail('a quaternion of length 1', seen, LENGTH_OFF)
        steps = [
            (_pose(one), _pose(other), before, now)
            for (before, one), (now, other) in pairwise(pairs)
        ]
        for pose, came, before, now in steps:
            roll = _rolled(before, now)
            right = roll.then(pose)
            if _near(right, came, SAME_M + roll.unsure):
                continue
            left, right_wheel = now.left - before.left, now.right - before.right
            raise Fail(
                f'{_in_words(right)}, after {_in_words(pose)} and {figure(left)} rad more of the '
                f'left wheel, {figure(right_wheel)} rad of the right one',
                _in_words(came),
                _why(steps),
            )
        return (
            f'{many(len(steps), "step")} of the wheels, the last one to {_in_words(steps[-1][1])}.'
        )


_Step = tuple[Pose, Pose, _Reading, _Reading]


def _near(one: Pose, other: Pose, near: float) -> bool:
    turned = abs(wrap_angle(one.yaw - other.yaw))
    return math.dist(one[:2], other[:2]) <= near and turned <= SAME_RAD


def _why(steps: Sequence[_Step]) -> Mistake:
    """Return the mistake that tells all steps."""
    for mistake, model in _MODELS:
        if all(_fits(model(p, a, b), p, q) for p, q, a, b in steps):
            return mistake
    for mistake, turns in _TURNS:
        if all(_moves(p, q, _rolled(a, b), turns) for p, q, a, b in steps):
            return mistake
    return ELSEWHERE


def _fits(told: Pose, pose: Pose, came: Pose) -> bool:
    # With a mistake, too, who goes straight ahead is off by way and turn: see `unsure`.
    way, turn = math.dist(told[:2], pose[:2]), abs(wrap_angle(told.yaw - pose.yaw))
    return _near(told, came, 10 * SAME_M + way * turn)


def _moves(pose: Pose, came: Pose, roll: _Roll, turns: float) -> bool:
    """Tell whether it has gone so far, whatever its heading, and says so many times the turn."""
    way = math.dist(pose[:2], came[:2])
    turned = wrap_angle(came.yaw - pose.yaw - turns * roll.turn)
    return abs(way - abs(roll.way)) <= 10 * SAME_M + roll.unsure and abs(turned) <= SAME_RAD


@dataclass(frozen=True)
class _Header(GraphClause):
    """It says of which frames it speaks, and of when."""

    text = WORDS.of(base=BASE, odom=ODOM).clause('header')

    def judge(self, evidence: Evidence) -> str:
        for reading, message in _pairs(evidence):
            frames = message.header.frame_id, message.child_frame_id
            _refuse_frames(frames, FRAMES_SWAPPED if frames == (BASE, ODOM) else FRAMES)
            _refuse_stamp(reading, message.header.stamp, STAMP)
        return ''


def _refuse_frames(frames: tuple[str, str], mistake: Mistake) -> None:
    if frames != (ODOM, BASE):
        names = 'frame_id = {!r}, child_frame_id = {!r}'
        raise Fail(names.format(ODOM, BASE), names.format(*frames), mistake)


def _refuse_stamp(reading: _Reading, stamp: Any, mistake: Mistake) -> None:
    said = stamp.sec * SECOND + stamp.nanosec
    if said != reading.stamp:
        seen = f'a stamp {figure((said - reading.stamp) / SECOND)} s after it' if said else '0'
        raise Fail(f'the stamp of the message on {HEARS}', seen, mistake if said else NO_STAMP)


@dataclass(frozen=True)
class _Transform(GraphClause):
    """The same goes to tf2."""

    text = WORDS.of(topic=TF_TOPIC).clause('transform')

    @property
    def roles(self) -> dict[Role, str]:
        return {(PUBLISHER, TF_TOPIC): TF}

    def find(self, evidence: Evidence) -> None:
        probe, node = evidence.probe, evidence.publisher(SAYS).node

        def speaks() -> bool:
            return node in {end.node for end in probe.publishers(TF_TOPIC)}

        if not probe.wait_to_appear(speaks):
            raise Fail(f'{node} publishes on {TF_TOPIC}', 'it does not', NO_TRANSFORM)

    def judge(self, evidence: Evidence) -> str:
        pairs, came = _pairs(evidence), _transforms(evidence)
        if len(came) < len(pairs):
            seen = f'{len(came)} for {many(len(pairs), "message")} on {SAYS}'
            raise Fail(f'a transform for each message on {SAYS}', seen, NO_TRANSFORM)
        for (reading, message), transform in zip(pairs, came[-len(pairs) :], strict=True):
            frames = transform.header.frame_id, transform.child_frame_id
            _refuse_frames(frames, TRANSFORM_FRAMES)
            right, place = _place(message), Place.of(transform.transform)
            if not _same(place, right):
                mistake = TRANSFORM_BACK if _same(place, right.back) else TRANSFORM
                raise Fail(f'as on {SAYS}: {_told(right)}', _told(place), mistake)
            _refuse_stamp(reading, transform.header.stamp, TRANSFORM_STAMP)
        return ''


def _transforms(evidence: Evidence) -> list[Any]:
    """Return the transforms of the robot as a whole that the node has sent."""
    return [
        each
        for sample in evidence.life.on(TF_TOPIC)
        if sample.node != ROBOT
        for each in sample.message.transforms
        if {each.header.frame_id, each.child_frame_id} & {ODOM, BASE}
    ]


def _place(message: Any) -> Place:
    at, turn = message.pose.pose.position, message.pose.pose.orientation
    return Place((at.x, at.y, at.z), (turn.x, turn.y, turn.z, turn.w))


def _same(one: Place, other: Place) -> bool:
    return one.is_rotation and one.away(other) <= SAME_M and one.turned(other) <= LENGTH


def _told(place: Place) -> str:
    return f'{metres(place.shift)}; z = {figure(place.turn[2])}, w = {figure(place.turn[3])}'


def _draw(now: int) -> list[_Reading]:
    """Return what the wheels of a robot tell that drives: in curves, on the spot, and back.

    Args:
        now: The stamp of the first message, ns.
    """
    left = random.choice((-1, 1)) * random.uniform(5, 20)
    right = left + random.uniform(0.5, 1.5)
    found = []
    # One more: the first one tells where the wheels begin, and the second where the robot does.
    for number in range(STEPS + 2):
        found.append(_Reading(now, left, right, random.random() < 0.5))
        way = random.choice((-1, 1, 1)) * random.uniform(*WAY)
        turn = random.choice((-1, 1)) * random.uniform(*TURN)
        if number % 8 == 6:
            way, turn = random.choice(((0.0, turn), (way, 0.0), (0.0, 0.0)))
        left += (way - turn * SEPARATION / 2) / RADIUS
        right += (way + turn * SEPARATION / 2) / RADIUS
        now += round(random.uniform(*STEP_SEC) * SECOND)
    return found


exercise = Exercise(
    words=WORDS,
    clauses=(ANSWERS, _Pose(), _Header(), _Transform()),
    shared=(HEARS, TF_TOPIC),
)
