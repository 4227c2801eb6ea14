"""Exercise: an action server that rejects goals."""

from __future__ import annotations

import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Fail, Mistake, Solution
from labkit.exercises.clauses import Goal, Pursues, Pursuit, Serves
from labkit.lessons.interfaces_and_actions.goals import (
    ACTION,
    expect_ending,
    fibonacci_goals,
    order_of,
    results,
)

__all__ = ['exercise']

NAME = '/stairs'
LEAST, MOST = 1, 20
ALLOWED = range(LEAST, MOST + 1)


NONE_REJECTED = Mistake(
    'stairs/none-rejected',
    'No goal at all was rejected: there is no goal_callback, or it accepts each goal.',
    'ActionServer(..., goal_callback=self.on_goal), which returns GoalResponse.REJECT for some',
)
SOME_REJECTED = Mistake(
    'stairs/some-rejected',
    'Others were rejected, and this one was not.',
    'Compare the limits in goal_callback with those of the task.',
)
TOO_LATE = Mistake(
    'stairs/too-late',
    'It was accepted first. What execute_callback does comes too late to reject a goal.',
    'ActionServer(..., goal_callback=self.on_goal), which returns GoalResponse.REJECT for some',
)


def _draw() -> list[Goal]:
    """Return goals with both limits, what is next to them, and some further inside and outside.

    One comes twice in a row.
    """
    inside, outside = random.randint(LEAST + 1, MOST - 1), random.randint(MOST + 2, 99)
    orders = [LEAST, MOST, inside, LEAST - 1, MOST + 1, -outside, -1, outside]
    random.shuffle(orders)
    orders.insert(orders.index(inside), inside)
    return fibonacci_goals(*orders)


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
    name='stairs',
    task='Serve the action /stairs, which rejects some goals.',
    clauses=(
        Serves(NAME, ACTION),
        Pursues(
            NAME,
            f'a goal whose `order` is from {LEAST} to {MOST} is accepted, any other one is '
            'rejected',
            _draw,
            _accepts,
        ),
        Pursues(
            NAME,
            f'an accepted goal succeeds, and its result is the numbers from {LEAST} to `order`',
            lambda: fibonacci_goals(random.randint(5, 9), random.randint(2, 4), LEAST, MOST),
            results(lambda order: list(range(LEAST, order + 1))),
        ),
    ),
    hints=[
        'A callback of its own is asked before a goal is accepted.',
        'ActionServer(..., goal_callback=self.on_goal); it gets the goal, and no handle.',
        'return GoalResponse.ACCEPT or GoalResponse.REJECT, from rclpy.action',
    ],
    answer=Solution(
        __file__,
        'stairs.py',
        'goal_callback is asked before anything is done. A client that is rejected learns it at '
        'once, and execute is not called.',
    ),
)
