"""Exercise: a node that computes how far a robot has driven, whoever publishes its odometry."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

from labkit.exercises import Exercise, Fail, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Clause, Evidence, Subscribes, Test, find_stage
from labkit.exercises.expect.timing import hanging, spun
from labkit.exercises.watch import Sample
from labkit.lessons._script import in_process

__all__ = ['distance']

INNER, OUTER = '/odom', '/distance'
ODOMETRY, FLOAT64 = 'nav_msgs/msg/Odometry', 'std_msgs/msg/Float64'
# A longer step at once is none that was driven, m. See the words of the task.
JUMP = 0.5
# What is smaller is no mistake of the node, m: sums may be made in any order.
NEAR = 1e-6

_NODE = """
import math

from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float64


class Distance(Node):
    def __init__(self):
        super().__init__('distance')
        self.publisher = self.create_publisher(Float64, 'distance', 10)
        self.subscription = self.create_subscription(Odometry, 'odom', self.on_odometry, 10)
        self.last = None
        self.total = 0.0

    def on_odometry(self, msg):
        position = msg.pose.pose.position
        place = (position.x, position.y)
        if self.last is not None:
            step = math.dist(self.last, place)
            if step < 0.5:
                self.total += step
        self.last = place
        self.publisher.publish(Float64(data=self.total))


distance = lab.spin(Distance())
"""
_STEP = '            step = math.dist(self.last, place)\n'
_IF = '            if step < 0.5:\n                self.total += step\n'


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
class _SumOfSteps(Clause):
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
        self, evidence: Evidence, ways: Sequence[_Way], came: Sequence[Sample]
    ) -> None:
        if came or not ways:
            return
        hanging(evidence.probe)
        raise Fail(
            f'a message on {OUTER} for each one on {INNER}',
            f'{len(ways)} messages on {INNER}, and nothing on {OUTER}',
            why='The callback does not publish.',
            todo='Publish at the end of the callback: '
            'self.publisher.publish(Float64(data=self.total))',
        )

    def _refuse_beginning(self, came: Sequence[Sample]) -> None:
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
        hanging(evidence.probe)
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
class _NoJumps(Clause):
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


def _ways(samples: Sequence[Sample]) -> list[_Way]:
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


def _answer(way: _Way, after: float, came: Sequence[Sample]) -> float | None:
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


distance = Exercise(
    name='distance',
    task='Tell how far a robot has driven, from its odometry or from a bag of it.',
    publishes={OUTER: FLOAT64},
    subscribes={INNER: ODOMETRY},
    clauses=[Subscribes(INNER, ODOMETRY), _SumOfSteps(), _NoJumps()],
    hints=[
        'Keep two things in the node: the place of the last message, and the sum.',
        'At the first message there is no last place yet: begin with self.last = None.',
        'math.dist((x1, y1), (x2, y2)) is the length of a step. Compare it with 0.5 before you '
        'add it.',
    ],
    answer=Solution(
        _NODE,
        'The node keeps the last place, adds each step, and leaves out jumps. It need not know '
        'whether a robot publishes, or a bag.',
    ),
    styles=[
        Style('own process', in_process(_NODE), process=True),
        Style(
            'hypot',
            changed(
                _NODE,
                (
                    _STEP,
                    '            dx, dy = place[0] - self.last[0], place[1] - self.last[1]\n'
                    '            step = math.hypot(dx, dy)\n',
                ),
            ),
        ),
        Style(
            'numpy',
            changed(
                _NODE,
                ('import math\n\n', 'import numpy as np\n'),
                ('place = (position.x, position.y)', 'place = np.array([position.x, position.y])'),
                ('math.dist(self.last, place)', 'float(np.linalg.norm(place - self.last))'),
            ),
        ),
        Style(
            'list of places',
            changed(
                _NODE,
                (
                    '        self.last = None\n        self.total = 0.0\n',
                    '        self.places = []\n',
                ),
                (
                    '        place = (position.x, position.y)\n'
                    '        if self.last is not None:\n'
                    + _STEP
                    + _IF
                    + '        self.last = place\n'
                    '        self.publisher.publish(Float64(data=self.total))\n',
                    '        self.places.append((position.x, position.y))\n'
                    '        steps = map(math.dist, self.places, self.places[1:])\n'
                    '        total = sum(step for step in steps if step < 0.5)\n'
                    '        self.publisher.publish(Float64(data=float(total)))\n',
                ),
            ),
        ),
        Style(
            'function',
            """
import math

from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import Float64

node = lab.spin(Node('distance'))
publisher = node.create_publisher(Float64, '/distance', 10)
state = {'last': None, 'total': 0.0}


def on_odometry(msg):
    place = (msg.pose.pose.position.x, msg.pose.pose.position.y)
    step = math.dist(state['last'] or place, place)
    state['last'] = place
    state['total'] += step if step < 0.5 else 0.0
    publisher.publish(Float64(data=state['total']))


node.create_subscription(Odometry, '/odom', on_odometry, 10)
""",
        ),
    ],
    wrong=[
        Wrong(
            'straight line',
            changed(
                _NODE,
                (
                    _STEP + _IF,
                    '            self.total = math.dist(self.first, place)\n',
                ),
                (
                    '        self.last = place\n',
                    '        else:\n            self.first = place\n        self.last = place\n',
                ),
            ),
            'It is the straight line to where the robot is now.',
        ),
        Wrong(
            'x alone',
            changed(_NODE, ('math.dist(self.last, place)', 'abs(place[0] - self.last[0])')),
            'Only x is counted.',
        ),
        Wrong(
            'x and y added',
            changed(
                _NODE,
                (
                    'math.dist(self.last, place)',
                    'abs(place[0] - self.last[0]) + abs(place[1] - self.last[1])',
                ),
            ),
            'The robot drives the diagonal of the two.',
        ),
        Wrong(
            'a limit that is too high',
            changed(_NODE, ('step < 0.5', 'step < 1.0')),
            'The jump was counted',
        ),
        Wrong(
            'a limit that is too low',
            changed(_NODE, ('step < 0.5', 'step < 0.4')),
            'Steps before this one were counted, and this one is not.',
        ),
        Wrong(
            'no root',
            changed(_NODE, ('math.dist(self.last, place)', 'math.dist(self.last, place) ** 2')),
            'The root is missing.',
        ),
        Wrong(
            'the last step alone',
            changed(_NODE, ('self.total += step', 'self.total = step')),
            'What is published is the last step alone',
        ),
        Wrong(
            'never renews the last place',
            changed(
                _NODE,
                (
                    '        self.last = place\n',
                    '        else:\n            self.last = place\n',
                ),
                ('step < 0.5', 'step < 5'),
            ),
            'the last place is never renewed',
        ),
        Wrong(
            'counts jumps',
            changed(_NODE, (_IF, '            self.total += step\n')),
            'The jump was counted as if the robot had driven it.',
        ),
        Wrong(
            'begins anew at a jump',
            changed(_NODE, (_IF, _IF + '            else:\n                self.total = 0.0\n')),
            'The sum begins anew at the jump.',
        ),
        Wrong(
            'from the origin',
            changed(
                _NODE,
                ('        self.last = place\n', '        self.last = (0.0, 0.0)\n'),
                ('step < 0.5', 'step < 50'),
            ),
            'The way from (0, 0) is added each time.',
        ),
        Wrong(
            'publishes only when something is added',
            changed(
                _NODE,
                (
                    '        self.publisher.publish(Float64(data=self.total))\n',
                    '',
                ),
                (
                    '                self.total += step\n',
                    '                self.total += step\n'
                    '                self.publisher.publish(Float64(data=self.total))\n',
                ),
            ),
            'Some messages are not answered.',
        ),
        Wrong(
            'publishes twice',
            changed(
                _NODE,
                (
                    '        self.publisher.publish(Float64(data=self.total))\n',
                    '        self.publisher.publish(Float64(data=self.total))\n'
                    '        self.publisher.publish(Float64(data=self.total))\n',
                ),
            ),
            'More is published than answers.',
        ),
        Wrong(
            'does not publish',
            changed(_NODE, ('        self.publisher.publish(Float64(data=self.total))\n', '')),
            'The callback does not publish.',
        ),
        Wrong(
            'no place at first',
            changed(_NODE, ('        if self.last is not None:\n', '        if True:\n')),
            'NoneType',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'begins at 1',
            changed(_NODE, ('self.total = 0.0', 'self.total = 1.0')),
            'The sum does not begin at 0.0',
        ),
        Wrong(
            'listens elsewhere',
            changed(_NODE, ("Odometry, 'odom'", "Odometry, 'odometry'")),
            '/odometry',
        ),
        Wrong(
            'another topic',
            changed(_NODE, ("Float64, 'distance'", "Float64, 'distances'")),
            '/distances',
        ),
    ],
)
