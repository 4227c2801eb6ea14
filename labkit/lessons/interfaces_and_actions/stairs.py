"""Exercise: an action server in a file, which rejects goals."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import Goal, Pursues, Pursuit, Serves
from labkit.exercises.draws import MANY, draw_outside
from labkit.lessons._terminal import RunsFile
from labkit.lessons.interfaces_and_actions.goals import (
    ACTION,
    LONG,
    expect_ending,
    fibonacci_goals,
    order_of,
    results,
)

__all__ = ['exercise']

WORDS = words_of(__file__)

NAME = '/stairs'
LEAST, MOST = 1, 20
ALLOWED = range(LEAST, MOST + 1)

NONE_REJECTED = WORDS.mistake('stairs/none-rejected')
SOME_REJECTED = WORDS.mistake('stairs/some-rejected')
TOO_LATE = WORDS.mistake('stairs/too-late')


def _draw() -> list[Goal]:
    """Return goals with both limits, what is next to them, and some further inside and outside.

    One comes twice in a row.
    """
    inside, outside = random.randint(LEAST + 1, MOST - 1), random.randint(MOST + 2, 99)
    orders = [LEAST, MOST, inside, LEAST - 1, MOST + 1, -outside, -1, outside]
    random.shuffle(orders)
    orders.insert(orders.index(inside), inside)
    near = [replace(goal, is_long=False) for goal in fibonacci_goals(*orders)]
    # A server that takes the first one of these is not to count up to the last.
    far = [n for n in draw_outside(LEAST, MOST) if n not in orders]
    return [*near, *(Goal({'order': order}, after_rejection=True) for order in far)]


def _draw_inside() -> list[Goal]:
    """Return goals that are accepted, so many that a server may have had enough."""
    many = random.choices(range(LEAST, LONG), k=MANY)
    return fibonacci_goals(random.randint(5, 9), random.randint(2, 4), LEAST, MOST, *many)


def _accepts(pursuits: Sequence[Pursuit]) -> None:
    outside = [pursuit for pursuit in pursuits if order_of(pursuit) not in ALLOWED]
    # What is wrong in the middle is not to look like a matter of limits.
    for pursuit in sorted(pursuits, key=lambda pursuit: abs(order_of(pursuit) - 10)):
        if pursuit not in outside:
            if not pursuit.accepted:
                expect_ending(pursuit, 'succeeded')
        elif pursuit.accepted:
            mistake = SOME_REJECTED
            if all(each.accepted for each in outside):
                mistake = NONE_REJECTED if pursuit.ending == 'succeeded' else TOO_LATE
            raise Fail(
                f'the goal with order = {order_of(pursuit)} is rejected',
                f'it was accepted, and {pursuit.ending}',
                mistake,
            )


exercise = Exercise(
    words=WORDS,
    clauses=(
        RunsFile('nodes/stairs.py', [NAME]),
        Serves(NAME, ACTION),
        Pursues(
            NAME,
            WORDS.of(least=LEAST, most=MOST).clause('pursues'),
            _draw,
            _accepts,
        ),
        Pursues(
            NAME,
            WORDS.of(least=LEAST).clause('pursues-2'),
            _draw_inside,
            results(lambda order: list(range(LEAST, order + 1))),
        ),
    ),
)
