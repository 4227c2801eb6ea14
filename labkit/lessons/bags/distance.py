"""Exercise: a node that computes how far a robot has driven, from whatever publishes odometry."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Generator
from functools import partial
from typing import Any

from labkit.exercises import Exercise, Mistake, Solution, anything
from labkit.exercises.clauses import Answers, Subscribes

__all__ = ['exercise']

ODOMETRY, FLOAT64 = 'nav_msgs/msg/Odometry', 'std_msgs/msg/Float64'
JUMP = 0.5
Place = tuple[float, float]


def _sums(
    begun: float | None,
    step: Callable[[Place, Place], float] = math.dist,
    add: Callable[[float, float], float] = lambda total, length: total + length,
    below: float = JUMP,
    jump: Callable[[float], float] = lambda total: total,
    renews: bool = True,
) -> Generator[float | None, Place, None]:
    """Answer each place with the sum of the steps, as the task asks for it or otherwise."""
    last, total = None, begun or 0.0
    place = yield None
    while True:
        if last is not None:
            length = step(last, place)
            total = add(total, length) if length < below else jump(total)
        if renews or last is None:
            last = place
        place = yield total


def _from_zero(begun: float | None) -> Generator[float | None, Place, None]:
    """Answer as it is right, with the way from (0, 0) to the first place besides."""
    place = yield None
    sums = _sums(begun)
    next(sums)
    more = math.hypot(*place)
    while True:
        place = yield (sums.send(place) or 0.0) + more


def _begins_otherwise(begun: float | None) -> Generator[Any, Place, None]:
    yield None
    yield anything()
    while True:
        yield None


_STEP = 'math.dist(self.last, place)'
_ADD = '            if step < 0.5:\n                self.total += step\n'
_RENEW = '        self.last = place\n'
_DIAGONAL = 'The step is math.dist(last, place), with x and y of the two messages.'
_PLACE = 'Keep the place of the message before: self.last = place'
_SUM = 'Add each step to what was there: self.total += step'
MISTAKES = (
    Mistake(
        'distance/a-limit-that-is-too-low',
        'Steps before this one were counted, and this one is not.',
        f'Each step that is shorter than {JUMP} m counts.',
        model=partial(_sums, below=0.4),
        change=[('step < 0.5', 'step < 0.4')],
    ),
    Mistake(
        'distance/the-last-step-alone',
        'What is published is the last step alone, not the sum of all steps.',
        _SUM,
        model=partial(_sums, add=lambda total, length: length),
        change=[('self.total += step', 'self.total = step')],
    ),
    Mistake(
        'distance/x-alone',
        'Only x is counted.',
        _DIAGONAL,
        model=partial(_sums, step=lambda last, place: abs(place[0] - last[0])),
        change=[(_STEP, 'abs(place[0] - self.last[0])')],
    ),
    Mistake(
        'distance/x-and-y-added',
        'The steps in x and in y are added. The robot drives the diagonal of the two.',
        _DIAGONAL,
        model=partial(
            _sums, step=lambda last, place: abs(place[0] - last[0]) + abs(place[1] - last[1])
        ),
        change=[(_STEP, 'abs(place[0] - self.last[0]) + abs(place[1] - self.last[1])')],
    ),
    Mistake(
        'distance/no-root',
        'The root is missing.',
        _DIAGONAL,
        model=partial(_sums, step=lambda last, place: math.dist(last, place) ** 2),
        change=[(_STEP, f'{_STEP} ** 2')],
    ),
    Mistake(
        'distance/counted-twice',
        'Each step is counted twice.',
        'Add it once.',
        model=partial(_sums, add=lambda total, length: total + 2 * length),
        change=[('self.total += step', 'self.total += 2 * step')],
    ),
    Mistake(
        'distance/from-the-origin',
        'The way from (0, 0) is added each time.',
        _PLACE,
        model=partial(_sums, step=lambda last, place: math.hypot(*place), below=math.inf),
        change=[(_RENEW, '        self.last = (0.0, 0.0)\n'), ('step < 0.5', 'step < 50')],
    ),
    Mistake(
        'distance/never-renews-the-last-place',
        'The way from the first place is added each time: the last place is never renewed.',
        _PLACE,
        model=partial(_sums, below=math.inf, renews=False),
        change=[(_RENEW, f'        else:\n    {_RENEW}'), ('step < 0.5', 'step < 5')],
    ),
    Mistake(
        'distance/straight-line',
        'It is the straight line to where the robot is now. A robot that drives round and comes '
        'back has driven, too.',
        'Add up the steps from message to message.',
        model=partial(_sums, add=lambda total, length: length, below=math.inf, renews=False),
        change=[
            (_ADD, '            self.total = step\n'),
            (_RENEW, f'        else:\n    {_RENEW}'),
        ],
    ),
    Mistake(
        'distance/counts-jumps',
        'The jump was counted as if the robot had driven it.',
        f'Add a step only if it is shorter than {JUMP} m. Keep the new place in any case.',
        model=partial(_sums, below=math.inf),
        change=[(_ADD, '            self.total += step\n')],
    ),
    Mistake(
        'distance/begins-anew-at-a-jump',
        'The sum begins anew at the jump.',
        'What was driven before has been driven: leave the sum as it is.',
        model=partial(_sums, jump=lambda total: 0.0),
        change=[(_ADD, f'{_ADD}            else:\n                self.total = 0.0\n')],
    ),
    Mistake(
        'distance/first-place',
        'The way from (0, 0) to the first place was counted. Nobody knows whether it was driven.',
        'Begin with self.last = None, and add nothing at the first message.',
        model=_from_zero,
        change=[('self.last = None', 'self.last = (0.0, 0.0)')],
    ),
    Mistake(
        'distance/begins-at-1',
        'The sum does not begin at 0.0.',
        'Begin with self.total = 0.0 and self.last = None.',
        model=_begins_otherwise,
        change=[('self.total = 0.0', 'self.total = 1.0')],
    ),
    Mistake(
        'distance/other-length', 'That is not the length of this step.', _DIAGONAL, model=anything
    ),
)


def _drive(middle: float) -> list[Place]:
    """Return places of a drive in all directions, with the shortest jump at its end."""
    # Also the sum of a step in x and in y is below the limit.
    steps = [(random.uniform(0.05, 0.35), random.uniform(-math.pi, math.pi)) for _ in range(8)]
    along_x = random.choice((0.0, math.pi)) + random.uniform(0.003, 0.008)
    steps.insert(random.randint(1, len(steps)), (random.uniform(0.485, 0.495), along_x))
    # As short as the steps of a slow robot that tells where it is a thousand times a second.
    steps.insert(random.randint(1, len(steps)), (random.uniform(3e-4, 9e-4), along_x))
    # It stands still for once, where it has not jumped.
    steps.insert(random.randint(2, len(steps)), (0.0, 0.0))
    # The first one is near the origin: the way from there is none that was driven.
    turn = random.uniform(-math.pi, math.pi)
    places = [(middle + 0.3 * math.cos(turn), 0.3 * math.sin(turn))]
    for length, yaw in steps:
        x, y = places[-1]
        places.append((x + length * math.cos(yaw), y + length * math.sin(yaw)))
    # So that its length is exactly that of the limit.
    x, y = (round(1024 * value) / 1024 for value in places[-1])
    return [*places[:-1], (x, y), (x + random.choice((-JUMP, JUMP)), y)]


exercise = Exercise(
    name='distance',
    task='Tell how far a robot has driven, from its odometry or from a bag of it.',
    clauses=(
        Subscribes('/odom', ODOMETRY),
        Answers(
            '/odom',
            '/distance',
            ODOMETRY,
            f'answer each message with a `{FLOAT64}` on `/distance`: the sum of all steps '
            f'(straight lines) shorter than {JUMP} m',
            answer=_sums,
            draw=lambda: [*_drive(0.0), *_drive(-10.0)],
            outer_type=FLOAT64,
            field=('pose.pose.position.x', 'pose.pose.position.y'),
            near=1e-6,
            mistakes=MISTAKES,
            resume=lambda place, said: [max(said, 0.0)],
            answers_all=True,
        ),
    ),
    hints=[
        'Keep two things in the node: the place of the last message, and the sum.',
        'At the first message there is no last place yet: begin with self.last = None.',
        'math.dist((x1, y1), (x2, y2)) is the length of a step. Compare it with 0.5 before you '
        'add it.',
    ],
    answer=Solution(
        __file__,
        'distance.py',
        'The node keeps the last place, adds each step, and leaves out jumps. It need not know '
        'whether a robot publishes, or a bag.',
    ),
)
