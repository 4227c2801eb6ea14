"""Exercise: the nearest thing that a scan sees, as a point in odom."""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field

from labkit.exercises import Exercise, Fail, Mistake, expect, words_of
from labkit.exercises.clauses import WITHIN, Evidence, GraphClause
from labkit.exercises.clauses.base import Test
from labkit.exercises.figures import figure
from labkit.exercises.messages_heard import Lived
from labkit.exercises.what_is_asked import PUBLISHER, SUBSCRIPTION, Role
from labkit.lessons.frames.places import TF, Place, metres, on_floor
from labkit.transforms.rotations import Vector

__all__ = ['exercise']

WORDS = words_of(__file__)

SCAN, POINT = 'sensor_msgs/msg/LaserScan', 'geometry_msgs/msg/PointStamped'
HEARS, SAYS, TF_TOPIC, ODOM = '/scan', '/nearest', '/tf', 'odom'
WITHIN_SEC = 1.0
# So many scans are sent, and so many of them are looked at for a mistake that they show together.
SCANS = 12
# How far a point may be off, m: distances are of four bytes.
NEAR = 2e-3
# Between two transforms, and so many before the scan and behind it, s.
STEP_SEC, STEPS = 0.1, 4
RANGE = 0.12, 3.5
SECOND = 10**9


@dataclass(frozen=True)
class _Shot:
    """A scan, and where the scanner was meanwhile.

    Attributes:
        stamp: When the scan was made, ns.
        body: The frame of the robot that carries the scanner.
        scanner: The frame of the scanner.
        poses: Where the robot was in odom: at each step before the scan and behind it.
        ratio: The moment of the scan between the two steps in the middle, 0 to 1.
        mount: Where the scanner is on the robot.
        angle_min: Where the first beam looks, rad.
        step: From one beam to the next, rad.
        ranges: The distances, m.
    """

    stamp: int
    body: str
    scanner: str
    poses: Sequence[Place]
    ratio: float
    mount: Place
    angle_min: float
    step: float
    ranges: Sequence[float]

    @property
    def at(self) -> Place:
        """Where the robot was when the scan was made."""
        return self.poses[STEPS - 1].between(self.poses[STEPS], self.ratio)

    def seen(
        self,
        *,
        valid: Callable[[float], bool] = lambda d: RANGE[0] <= d <= RANGE[1],
        first: float | None = None,
        unit: float = 1.0,
    ) -> Vector:
        """Return the nearest point, as the scanner sees it."""
        near, i = min((d, i) for i, d in enumerate(self.ranges) if valid(d))
        angle = ((self.angle_min if first is None else first) + i * self.step) * unit
        return near * math.cos(angle), near * math.sin(angle), 0.0

    def transforms(self) -> list[object]:
        """Return the transforms as messages."""
        found = []
        for number, pose in enumerate(self.poses):
            steps = number - STEPS + 1 - self.ratio
            then = self.stamp + round(steps * STEP_SEC * SECOND)
            found.append(pose.stamped(ODOM, self.body, then))
            found.append(self.mount.stamped(self.body, self.scanner, then))
        return found

    def fields(self) -> dict[str, object]:
        """Return the fields of the scan."""
        sec, nanosec = divmod(self.stamp, SECOND)
        return {
            'header.stamp.sec': sec,
            'header.stamp.nanosec': nanosec,
            'header.frame_id': self.scanner,
            'angle_min': self.angle_min,
            'angle_max': self.angle_min + self.step * (len(self.ranges) - 1),
            'angle_increment': self.step,
            'range_min': RANGE[0],
            'range_max': RANGE[1],
            'ranges': list(self.ranges),
        }


def _right(shot: _Shot) -> Vector:
    return shot.at.has(shot.mount.has(shot.seen()))


def _in_odom(shot: _Shot, point: Vector) -> Vector:
    return shot.at.has(shot.mount.has(point))


_MODELS: Sequence[tuple[Mistake, Callable[[_Shot], Vector]]] = (
    (
        WORDS.mistake('nearest/latest'),
        lambda shot: shot.poses[-1].has(shot.mount.has(shot.seen())),
    ),
    (WORDS.mistake('nearest/as-seen'), lambda shot: shot.seen()),
    (WORDS.mistake('nearest/in-robot'), lambda shot: shot.mount.has(shot.seen())),
    (
        WORDS.mistake('nearest/way-back'),
        lambda shot: shot.at.then(shot.mount).back.has(shot.seen()),
    ),
    (WORDS.mistake('nearest/no-mount'), lambda shot: shot.at.has(shot.seen())),
    (WORDS.mistake('nearest/first-beam'), lambda shot: _in_odom(shot, shot.seen(first=0.0))),
    (
        WORDS.mistake('nearest/invalid'),
        lambda shot: _in_odom(shot, shot.seen(valid=lambda d: not math.isnan(d))),
    ),
    (
        WORDS.mistake('nearest/too-near'),
        lambda shot: _in_odom(shot, shot.seen(valid=lambda d: 0 < d <= RANGE[1])),
    ),
    (
        WORDS.mistake('nearest/degrees'),
        lambda shot: _in_odom(shot, shot.seen(unit=180 / math.pi)),
    ),
)
NOTHING = WORDS.mistake('nearest/nothing')
SEVERAL = WORDS.mistake('nearest/several')
SOME = WORDS.mistake('nearest/some')
ELSEWHERE = WORDS.mistake('nearest/elsewhere')
FRAME = WORDS.mistake('nearest/frame')
STAMP = WORDS.mistake('nearest/stamp')


@dataclass(frozen=True)
class _Answers(GraphClause):
    """Each scan leads to one point."""

    text = WORDS.of(within=WITHIN).clause('answers')
    shots: list[_Shot] = field(default_factory=list, compare=False)
    # The robot of the lesson sends scans, too.
    still = ('/turtlebot',)

    @property
    def roles(self) -> dict[Role, str]:
        return {(SUBSCRIPTION, HEARS): SCAN, (PUBLISHER, SAYS): POINT}

    @property
    def listens(self) -> Collection[str]:
        return (SAYS,)

    def find(self, evidence: Evidence) -> None:
        says = evidence.publisher(SAYS)
        expect.qos(evidence.subscription(HEARS, says.node), reliability='best_effort')

    def tests(self, evidence: Evidence) -> Sequence[Test]:
        expect.spun(evidence.probe, evidence.publisher(SAYS))
        self.shots[:] = _draw()
        tests = []
        for shot in self.shots:
            tests.append(Test(TF_TOPIC, TF, {'transforms': shot.transforms()}, due=0))
            tests.append(Test(HEARS, SCAN, shot.fields(), (SAYS,)))
        return tests

    def judge(self, evidence: Evidence) -> str:
        answered = _answered(self, evidence)
        silent = [shot for shot, came in answered if not came]
        if len(silent) == len(answered):
            expected = f'a point on {SAYS} for each scan that comes on {HEARS}'
            raise Fail(expected, f'nothing for {len(silent)} scans', NOTHING)
        if silent:
            expected = f'a point on {SAYS} for each scan'
            raise Fail(expected, f'none for {len(silent)} of {len(answered)} scans', SOME)
        most = max(len(came) for _, came in answered)
        if most > 1:
            raise Fail(f'one point on {SAYS} for each scan', f'{most} for one of them', SEVERAL)
        return ''


def _answered(clause: _Answers, evidence: Evidence) -> list[tuple[_Shot, list[Lived]]]:
    """Return each scan with what came for it."""
    life = evidence.life
    sent = [each.at for each in evidence.tests.get(clause, ()) if each.topic == HEARS]
    return [
        (
            shot,
            [s for s in life.on(SAYS) if at <= s.at <= at + WITHIN_SEC + life.step],
        )
        for shot, at in zip(clause.shots, sent, strict=False)
    ]


ANSWERS = _Answers()


@dataclass(frozen=True)
class _InOdom(GraphClause):
    """The point is where it is."""

    text = WORDS.clause('in-odom')

    def judge(self, evidence: Evidence) -> str:
        pairs = [(shot, _point(came[0])) for shot, came in _answered(ANSWERS, evidence) if came]
        wrong = [(s, p) for s, p in pairs if not math.dist(_right(s), p) <= NEAR]
        if not wrong:
            return f'{len(pairs)} points in {ODOM}, the last one at {metres(pairs[-1][1])}.'
        shot, point = wrong[0]
        found = next((m for m, model in _MODELS if _fits(model, wrong)), ELSEWHERE)
        raise Fail(
            f'the nearest point at {metres(_right(shot))} in {ODOM}',
            f'{metres(point)}; {len(wrong)} of {len(pairs)} points are wrong',
            found,
        )


def _fits(model: Callable[[_Shot], Vector], wrong: Sequence[tuple[_Shot, Vector]]) -> bool:
    return all(math.dist(model(shot), point) <= NEAR for shot, point in wrong)


@dataclass(frozen=True)
class _Header(GraphClause):
    """Its header says in which frame it is, and when it was seen."""

    text = WORDS.clause('header')

    def judge(self, evidence: Evidence) -> str:
        for shot, came in _answered(ANSWERS, evidence):
            header = came[0].message.header
            if header.frame_id != ODOM:
                raise Fail(f'frame_id = {ODOM!r}', f'frame_id = {header.frame_id!r}', FRAME)
            stamp = header.stamp.sec * SECOND + header.stamp.nanosec
            if stamp != shot.stamp:
                late = (stamp - shot.stamp) / SECOND
                raise Fail('the stamp of the scan', f'a stamp {figure(late)} s after it', STAMP)
        return ''


def _point(sample: Lived) -> Vector:
    point = sample.message.point
    return point.x, point.y, point.z


def _draw() -> list[_Shot]:
    """Return scans of a robot that drives and turns; its frames have names of their own."""
    number = random.randint(100, 999)
    now = time.time_ns()
    uniform = random.uniform
    mount = on_floor(uniform(-0.2, 0.2), uniform(0.05, 0.2), uniform(-2.0, 2.0), uniform(0.1, 0.4))
    shots = []
    for n in range(SCANS):
        x, y, yaw = uniform(-2, 2), uniform(-2, 2), uniform(-3, 3)
        v, w = uniform(0.3, 0.6), random.choice((-1, 1)) * uniform(0.6, 1.2)
        poses = []
        for _ in range(2 * STEPS):
            poses.append(on_floor(x, y, yaw))
            x, y = x + v * STEP_SEC * math.cos(yaw), y + v * STEP_SEC * math.sin(yaw)
            yaw += w * STEP_SEC
        # Not through zero, so that a beam is not the same by its number and by its angle.
        first, beams = uniform(-2.8, -0.8), random.randint(40, 90)
        shots.append(
            _Shot(
                stamp=now + 2 * n * SECOND + random.randrange(SECOND // 2),
                body=f'robot_{number}',
                scanner=f'scanner_{number}',
                poses=poses,
                ratio=uniform(0.2, 0.8),
                mount=mount,
                angle_min=first,
                step=uniform(2.0, 5.0) / beams,
                ranges=_ranges(beams),
            )
        )
    return shots


def _ranges(beams: int) -> list[float]:
    """Return distances, of which one is the nearest that counts, and some do not count."""
    ranges = [random.uniform(1.0, 3.4) for _ in range(beams)]
    places = random.sample(range(1, beams), 5)
    for place, distance in zip(places, (random.uniform(0.3, 0.8), 0.0, math.inf), strict=False):
        ranges[place] = distance
    ranges[places[3]] = random.choice((math.nan, 9.0))
    ranges[places[4]] = random.uniform(0.02, 0.1)
    return ranges


exercise = Exercise(
    words=WORDS,
    clauses=(ANSWERS, _InOdom(), _Header()),
    shared=(HEARS,),
)
