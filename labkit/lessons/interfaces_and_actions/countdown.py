"""Exercise: an action server whose goals can be canceled on the way."""

from __future__ import annotations

import random
from collections.abc import Sequence
from itertools import pairwise

from labkit.exercises import Exercise, Fail, anything, words_of
from labkit.exercises.clauses import Goal, Pursues, Pursuit, Serves
from labkit.exercises.draws import MANY
from labkit.exercises.expect import apart
from labkit.exercises.figures import figure, many
from labkit.lessons.interfaces_and_actions.goals import (
    ACTION,
    expect_ending,
    expect_result,
    feedbacks,
    fibonacci_goals,
    numbers,
    order_of,
    results,
)

__all__ = ['exercise']

WORDS = words_of(__file__)

NAME = '/countdown'
# How long the pause before a number may be, s. A shorter one than the second is none.
PAUSE_SEC, AT_ONCE_SEC = 1.0, 1e-3
# So many numbers may be counted after a goal was canceled.
MORE = 1
# How long the goals of a clause may take, s.
LONGEST_SEC = 120.0

NO_FEEDBACK = WORDS.mistake('countdown/no-feedback', anything)
ALL_AT_ONCE = WORDS.mistake('countdown/all-at-once')
TOO_SLOW = WORDS.mistake('countdown/too-slow')
EMPTY_RESULT = WORDS.mistake('countdown/an-empty-result')
MORE_NUMBERS = WORDS.mistake('countdown/more-than-fed-back')
LATE = WORDS.mistake('countdown/late')
OTHERS = WORDS.mistake('countdown/other-numbers')


def _right(order: int) -> list[int]:
    return list(range(order, -1, -1))


def _counts(pursuits: Sequence[Pursuit]) -> None:
    results(_right)(pursuits)


def _feeds_back(pursuits: Sequence[Pursuit]) -> None:
    feedbacks(_right, [NO_FEEDBACK])(pursuits)
    for pursuit in pursuits:
        pauses = [later - before for before, later in pairwise(pursuit.times)]
        if not pursuit.exact or not pauses:
            continue
        shortest, longest = min(pauses), max(pauses)
        if shortest < AT_ONCE_SEC or longest > PAUSE_SEC + AT_ONCE_SEC:
            raise Fail(
                f'a pause before each number, up to {figure(PAUSE_SEC)} s',
                f'pauses from {figure(shortest)} s to {figure(longest)} s',
                ALL_AT_ONCE if shortest < AT_ONCE_SEC else TOO_SLOW,
            )


def _draw() -> list[Goal]:
    """Return goals: some short ones, the shortest, one that is longer, and many in the end."""
    some = random.randint(4, 6), random.randint(2, 3), 0, 1, random.randint(8, 12)
    # In real time they would take too long.
    many = [Goal({'order': random.randint(0, 1)}, is_long=True) for _ in range(MANY)]
    return [*fibonacci_goals(*some), *many]


def _draw_canceled() -> list[Goal]:
    return [
        _to_be_canceled(after=random.randint(3, 5)),
        *fibonacci_goals(2),
        _to_be_canceled(after=1),
    ]


def _to_be_canceled(after: int) -> Goal:
    # A server that can't be stopped is not to go on for long.
    return Goal({'order': random.randint(46, 52)}, cancel_after=after)


def _cancels(pursuits: Sequence[Pursuit]) -> None:
    first, second, last = pursuits
    _is_canceled(first)
    expect_result(second, _right(order_of(second)), numbers(first.result))
    _is_canceled(last)


def _is_canceled(pursuit: Pursuit) -> None:
    if pursuit.cancel_accepted is None:
        raise Fail(
            'a goal that takes so long that it can be canceled',
            f'it was {pursuit.ending}, with {len(pursuit.feedback)} feedbacks',
            ALL_AT_ONCE,
        )
    wanted, seen = _right(order_of(pursuit)), numbers(pursuit.result)
    expect_ending(pursuit, 'canceled', all_numbers=seen == wanted)
    least = pursuit.before_cancel
    mistake = OTHERS if seen else EMPTY_RESULT
    if wanted[: len(seen)] == seen:
        if least <= len(seen) <= least + MORE:
            return
        counted = len(pursuit.feedback) > least + MORE
        mistake = (LATE if counted else MORE_NUMBERS) if len(seen) > least else mistake
    expected, shown = apart(wanted[:least], seen)
    raise Fail(
        f'result = {expected}, as in the feedback before it was canceled, or {MORE} number more',
        f'result = {shown}, {many(len(seen), "number")}',
        mistake,
    )


exercise = Exercise(
    words=WORDS,
    clauses=(
        Serves(NAME, ACTION),
        Pursues(
            NAME,
            WORDS.clause('pursues'),
            _draw,
            _counts,
            LONGEST_SEC,
        ),
        Pursues(
            NAME,
            WORDS.of(pause=figure(PAUSE_SEC)).clause('pursues-2'),
            _draw,
            _feeds_back,
            LONGEST_SEC,
        ),
        Pursues(
            NAME,
            WORDS.of(more=MORE).clause('pursues-3'),
            _draw_canceled,
            _cancels,
            LONGEST_SEC,
        ),
    ),
)
