"""What the check of the exercise distance asks for."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

from labkit.exercises import Fail
from labkit.exercises.clauses import Clause, Evidence, Test, find_stage
from labkit.exercises.expect.spinning import hanging, spun
from labkit.exercises.watch import Lived

__all__ = ['FLOAT64', 'INNER', 'ODOMETRY', 'OUTER', 'NoJumps', 'SumOfSteps']

INNER, OUTER = '/odom', '/distance'
ODOMETRY, FLOAT64 = 'nav_msgs/msg/Odometry', 'std_msgs/msg/Float64'
# A longer step at once is none that was driven, m. See the words of the task.
JUMP = 0.5
# What is smaller is no mistake of the node, m: sums may be made in any order.
NEAR = 1e-6


@dataclass(frozen=True)
class _Way:
    """A step of a drawn drive: where it leads, and how long it is."""

    at: float
    x: float
    y: float
    step: float

    @property
    def counts(self) -> bool:
        """Whether it was driven."""
        return self.step < JUMP


@dataclass(frozen=True, eq=False)
class SumOfSteps(Clause):
    """Each message is answered with the sum of all steps so far."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return (
            f'answer each message with one `{FLOAT64}` on `{OUTER}`: how far the robot has driven '
            'since the node began, in metres, the sum of all steps in x and y'
        )

    def find(self, evidence: Evidence) -> None:
        """Look for the node."""
        key = ('subscription', INNER, '')
        if key not in evidence.ends or ('publisher', OUTER, '') not in evidence.ends:
            fields = {'pose.pose.position.x': 0.0}
            ends = find_stage(evidence.probe, INNER, OUTER, fields)
            evidence.ends[key], evidence.ends['publisher', OUTER, ''] = ends

    def tests(self, evidence: Evidence) -> Sequence[Test]:
        """Return a drawn drive, and another one that begins somewhere else."""
        spun(evidence.probe, evidence.subscription(INNER))
        return [
            Test(
                INNER,
                ODOMETRY,
                {'pose.pose.position.x': x, 'pose.pose.position.y': y},
                (OUTER,),
            )
            for x, y in [*_drive(10.0), *_drive(-10.0)]
        ]

    def judge(self, evidence: Evidence) -> str:
        """Judge what each step has added."""
        life = evidence.life
        came = life.on(OUTER)
        ways = _ways(life.on(INNER))
        answers = [_answer(way, after, came) for way, after in _following(ways, life.seconds)]
        self._refuse_silence(evidence, ways, came)
        for number in range(1, len(ways)):
            way, before, now = ways[number], answers[number - 1], answers[number]
            if before is None or now is None:
                self._refuse_missing(evidence, way)
            wanted = way.step if way.counts else 0.0
            if way.counts and abs(now - before - wanted) > NEAR:
                self._refuse(ways, answers, number)
        self._refuse_beginning(came)
        if len(came) > len(ways):
            raise Fail(
                f'{len(ways)} messages on {OUTER}, one for each on {INNER}',
                f'{len(came)}',
                why='More is published than answers.',
                todo=f'Publish in the callback for {INNER}, once, and nowhere else.',
            )
        total = sum(way.step for way in ways[1:] if way.counts)
        return f'{len(ways)} places on {INNER}: {total:.2f} m were counted.'

    def _refuse_silence(
        self, evidence: Evidence, ways: Sequence[_Way], came: Sequence[Lived]
    ) -> None:
        if came or not ways:
            return
        hanging()
        raise Fail(
            f'a message on {OUTER} for each one on {INNER}',
            f'{len(ways)} messages on {INNER}, and nothing on {OUTER}',
            why='The callback does not publish.',
            todo='Publish at the end of the callback: '
            'self.publisher.publish(Float64(data=self.total))',
        )

    def _refuse_beginning(self, came: Sequence[Lived]) -> None:
        """Raise Fail if the first message of a node, if that is seen, is not 0."""
        begun = [float(sample.message.data) for sample in came if sample.number == 1]
        values = [*begun, *(float(s.message.data) for s in came if s.message.data < -NEAR)]
        if values and abs(values[0]) > NEAR:
            raise Fail(
                f'0.0 m as the first message on {OUTER}: nothing has been driven yet',
                f'{values[0]:.3f} m',
                why='The sum does not begin at 0.0, or the way to the first place is counted.',
                todo='Begin with self.total = 0.0 and self.last = None.',
            )

    def _refuse_missing(self, evidence: Evidence, way: _Way) -> NoReturn:
        hanging()
        raise Fail(
            f'a message on {OUTER} for each one on {INNER}',
            f'none when the robot had come to x = {way.x:.2f} m, y = {way.y:.2f} m',
            why='Some messages are not answered.',
            todo='Publish at the end of the callback, outside of any if.',
        )

    def _refuse(
        self, ways: Sequence[_Way], answers: Sequence[float | None], number: int
    ) -> NoReturn:
        way, last = ways[number], ways[number - 1]
        before, now = answers[number - 1], answers[number]
        assert before is not None and now is not None
        why, todo = _explain(ways[: number + 1], before, now)
        raise Fail(
            f'{way.step:.3f} m more on {OUTER} for the step from ({last.x:.2f}, {last.y:.2f}) to '
            f'({way.x:.2f}, {way.y:.2f})',
            f'{before:.3f} m, then {now:.3f} m: {now - before:.3f} m more',
            why=why,
            todo=todo,
        )


@dataclass(frozen=True, eq=False)
class NoJumps(Clause):
    """What was not driven is not counted."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return f'do not count a step of {JUMP} m or more: there a bag begins anew'

    def judge(self, evidence: Evidence) -> str:
        """Judge what a jump has added."""
        life = evidence.life
        ways, came = _ways(life.on(INNER)), life.on(OUTER)
        answers = [_answer(way, after, came) for way, after in _following(ways, life.seconds)]
        for number in range(1, len(ways)):
            way, before, now = ways[number], answers[number - 1], answers[number]
            if way.counts or before is None or now is None or abs(now - before) < NEAR:
                continue
            why, todo = (
                'The jump was counted as if the robot had driven it.',
                f'Add a step only if it is shorter than {JUMP} m. Keep the new place in any case.',
            )
            if now < before:
                why = 'The sum begins anew at the jump.'
                todo = 'What was driven before has been driven: let the sum as it is.'
            raise Fail(
                f'nothing more on {OUTER} for a jump of {way.step:.1f} m',
                f'{before:.3f} m, then {now:.3f} m',
                why=why,
                todo=todo,
            )
        return ''


def _drive(middle: float) -> list[tuple[float, float]]:
    """Return places of a drive with bends, in all directions, and of the shortest jump at its end.

    The sum of a step in x and in y is below the limit, too: who adds these is told so.
    """
    steps = [(random.uniform(0.05, 0.35), random.uniform(-math.pi, math.pi)) for _ in range(5)]
    almost = random.uniform(0.44, 0.47), random.choice((0.0, math.pi)) + random.uniform(0.01, 0.04)
    steps.insert(random.randint(1, len(steps)), almost)
    places = [(middle + random.uniform(-1, 1), random.uniform(3, 9) * random.choice((-1, 1)))]
    for length, yaw in steps:
        x, y = places[-1]
        places.append((x + length * math.cos(yaw), y + length * math.sin(yaw)))
    # So that its length is exactly that of the limit.
    x, y = (round(1024 * value) / 1024 for value in places[-1])
    return [*places[:-1], (x, y), (x + random.choice((-JUMP, JUMP)), y)]


def _ways(samples: Sequence[Lived]) -> list[_Way]:
    found: list[_Way] = []
    for sample in samples:
        position = sample.message.pose.pose.position
        place = (position.x, position.y)
        step = math.dist((found[-1].x, found[-1].y), place) if found else math.inf
        found.append(_Way(sample.at, *place, step))
    return found


def _following(ways: Sequence[_Way], end: float) -> list[tuple[_Way, float]]:
    """Return each message with the time at which the next one came."""
    return [
        (way, later.at if later is not None else end + 1.0)
        for way, later in zip(ways, [*ways[1:], None], strict=True)
    ]


def _answer(way: _Way, after: float, came: Sequence[Lived]) -> float | None:
    """Return the last answer to a message, before the next one came."""
    values = [float(s.message.data) for s in came if way.at <= s.at < after]
    return values[-1] if values else None


def _explain(ways: Sequence[_Way], before: float, now: float) -> tuple[str, str]:
    """Return the misconception behind a wrong sum, and the next step."""
    last, way = ways[-2], ways[-1]
    more, dx, dy = now - before, way.x - last.x, way.y - last.y

    def is_(value: float) -> bool:
        return abs(more - value) < NEAR

    if is_(0.0) and before > NEAR:
        return (
            'Steps before this one were counted, and this one is not.',
            f'Each step that is shorter than {JUMP} m counts.',
        )
    if is_(0.0):
        return (
            'The sum does not grow although the robot moves.',
            'Keep the place of each message, and add the way from there to the next one.',
        )
    if abs(now - way.step) < NEAR:
        return (
            'What is published is the last step alone, not the sum of all steps.',
            'Add each step to what was there: self.total += step',
        )
    if is_(dx) or is_(abs(dx)):
        return 'Only x is counted.', 'The way has two parts: math.hypot(dx, dy)'
    if is_(dx + dy) or is_(abs(dx) + abs(dy)):
        return (
            'The steps in x and in y are added. The robot drives the diagonal of the two.',
            'math.hypot(dx, dy) is the diagonal, and so is math.dist(last, place).',
        )
    if is_(dx * dx + dy * dy):
        return 'The root is missing.', 'math.hypot(dx, dy), or math.dist(last, place)'
    if is_(-way.step):
        return 'The sum shrinks: the step is subtracted.', 'self.total += step'
    if is_(2 * way.step):
        return 'Each step is counted twice.', 'Add it once, and run one node only.'
    if is_(math.hypot(way.x, way.y)):
        return (
            'The way from (0, 0) is added each time.',
            'Keep the place of the message before: self.last = place',
        )
    begun = _begun(ways)
    if is_(math.dist(begun, (way.x, way.y))):
        return (
            'The way from the first place is added each time: the last place is never renewed.',
            'self.last = place belongs to each message, not only to the first one.',
        )
    lines = (math.dist((ways[0].x, ways[0].y), (way.x, way.y)), math.hypot(way.x, way.y))
    if any(abs(now - line) < NEAR for line in lines) or now < before:
        return (
            'It is the straight line to where the robot is now. A robot that drives round and '
            'comes back has driven, too.',
            'Add up the steps from message to message.',
        )
    return (
        'That is not the length of this step.',
        'The step is math.dist(last, place), with x and y of the two messages.',
    )


def _begun(ways: Sequence[_Way]) -> tuple[float, float]:
    """Return where the drive began that the last step belongs to."""
    for way in reversed(ways):
        if not way.counts:
            return way.x, way.y
    return ways[0].x, ways[0].y
