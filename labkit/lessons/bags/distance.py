"""Exercise: a node that computes how far a robot has driven, from whatever publishes odometry."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Generator
from functools import partial
from typing import Any

from labkit.exercises import Exercise, anything, words_of
from labkit.exercises.clauses import Answers, Subscribes

__all__ = ['exercise']

WORDS = words_of(__file__)

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


MISTAKES = (
    WORDS.mistake('distance/a-limit-that-is-too-low', partial(_sums, below=0.4)),
    WORDS.mistake(
        'distance/the-last-step-alone', partial(_sums, add=lambda total, length: length)
    ),
    WORDS.mistake(
        'distance/x-alone', partial(_sums, step=lambda last, place: abs(place[0] - last[0]))
    ),
    WORDS.mistake(
        'distance/x-and-y-added',
        partial(_sums, step=lambda last, place: abs(place[0] - last[0]) + abs(place[1] - last[1])),
    ),
    WORDS.mistake(
        'distance/no-root', partial(_sums, step=lambda last, place: math.dist(last, place) ** 2)
    ),
    WORDS.mistake(
        'distance/counted-twice', partial(_sums, add=lambda total, length: total + 2 * length)
    ),
    WORDS.mistake(
        'distance/from-the-origin',
        partial(_sums, step=lambda last, place: math.hypot(*place), below=math.inf),
    ),
    WORDS.mistake(
        'distance/never-renews-the-last-place', partial(_sums, below=math.inf, renews=False)
    ),
    WORDS.mistake(
        'distance/straight-line',
        partial(_sums, add=lambda total, length: length, below=math.inf, renews=False),
    ),
    WORDS.mistake('distance/counts-jumps', partial(_sums, below=math.inf)),
    WORDS.mistake('distance/begins-anew-at-a-jump', partial(_sums, jump=lambda total: 0.0)),
    WORDS.mistake('distance/first-place', _from_zero),
    WORDS.mistake('distance/begins-at-1', _begins_otherwise),
    WORDS.mistake('distance/other-length', anything),
)


def _drive(middle: float) -> list[Place]:
    """Return places of a drive in all directions, with the shortest jump at its end."""
    # Also the sum of a step in x and in y is below the limit.
    steps = [(random.uniform(0.05, 0.35), random.uniform(-math.pi, math.pi)) for _ in range(14)]
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
    words=WORDS,
    clauses=(
        Subscribes('/odom', ODOMETRY),
        Answers(
            '/odom',
            '/distance',
            ODOMETRY,
            WORDS.clause('answers'),
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
)
