"""What becomes of the goals that the checks of this lesson send, and what is often wrong."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from labkit.exercises import Fail, Mistake, words_of
from labkit.exercises.clauses import Goal, Pursuit
from labkit.exercises.expect import apart

__all__ = [
    'ACTION',
    'LONG',
    'expect_ending',
    'expect_result',
    'feedbacks',
    'fibonacci_goals',
    'numbers',
    'order_of',
    'results',
]

WORDS = words_of(__file__)

ACTION = 'test_msgs/action/Fibonacci'
# A goal with a larger order may take long.
LONG = 6
Numbers = list[int]
Rule = Callable[[Sequence[Pursuit]], None]

NOT_SAID = WORDS.mistake('goals/aborted')
RAISED = WORDS.mistake('goals/raised')
SAID_ABORT = WORDS.mistake('goals/said-abort')
REJECTED = WORDS.mistake('goals/rejected')
CANCEL_REJECTED = WORDS.mistake('goals/cancel-rejected')
GOES_ON = WORDS.mistake('goals/goes-on')
SAID_SUCCEED = WORDS.mistake('goals/said-succeed')
OTHER_ENDING = WORDS.mistake('goals/other-ending')
EMPTY = WORDS.mistake('goals/empty')
STILL_THERE = WORDS.mistake('goals/still-there')
OTHERS = WORDS.mistake('goals/others')


def fibonacci_goals(*orders: int) -> list[Goal]:
    """Return goals with these orders."""
    return [Goal({'order': order}, is_long=order > LONG) for order in orders]


def order_of(pursuit: Pursuit) -> int:
    """Return the order of a goal."""
    return int(pursuit.goal.fields['order'])


def numbers(message: object) -> Numbers:
    """Return the numbers of a result or a feedback."""
    return [int(number) for number in getattr(message, 'sequence', ())]


def expect_ending(pursuit: Pursuit, wanted: str, *, all_numbers: bool = True) -> None:
    """Raise Fail unless a goal has ended as wanted.

    Args:
        pursuit: What has become of it.
        wanted: `'succeeded'` or `'canceled'`.
        all_numbers: Whether its result has all of the numbers.
    """
    if pursuit.ending == wanted:
        return
    mistake = OTHER_ENDING
    if pursuit.ending == 'aborted':
        mistake = RAISED if pursuit.raised else NOT_SAID if pursuit.not_said else SAID_ABORT
        mistake = mistake.of(method='canceled' if wanted == 'canceled' else 'succeed')
    elif pursuit.ending == 'rejected':
        mistake = REJECTED
    elif pursuit.cancel_accepted is False:
        mistake = CANCEL_REJECTED
    elif wanted == 'canceled':
        mistake = GOES_ON if all_numbers else SAID_SUCCEED
    raise Fail(
        f'the goal with order = {order_of(pursuit)} is {wanted}',
        f'it was {pursuit.ending}',
        mistake.of(order=order_of(pursuit), wanted=wanted),
    )


def expect_result(pursuit: Pursuit, wanted: Numbers, before: Numbers) -> None:
    """Raise Fail unless a goal succeeds with these numbers; `before` are those of the last one."""
    expect_ending(pursuit, 'succeeded')
    seen = numbers(pursuit.result)
    if seen == wanted:
        return
    mistake = OTHERS if seen else EMPTY
    if before and seen[: len(before)] == before and len(seen) > len(wanted):
        mistake = STILL_THERE
    expected, shown = apart(wanted, seen)
    raise Fail(
        f'result = {expected} for order = {order_of(pursuit)}', f'result = {shown}', mistake
    )


def results(right: Callable[[int], Numbers]) -> Rule:
    """Return a rule: each goal succeeds, and its result is right for its order."""

    def rule(pursuits: Sequence[Pursuit]) -> None:
        before: Numbers = []
        for pursuit in pursuits:
            wanted = right(order_of(pursuit))
            expect_result(pursuit, wanted, before)
            before = wanted

    return rule


def feedbacks(right: Callable[[int], Numbers], mistakes: Sequence[Mistake]) -> Rule:
    """Return a rule: after each number of a result there is a feedback with those so far.

    Args:
        right: Returns the result from the order.
        mistakes: Their models return the feedbacks from the result.
    """

    def rule(pursuits: Sequence[Pursuit]) -> None:
        for pursuit in pursuits:
            expect_ending(pursuit, 'succeeded')
            result = right(order_of(pursuit))
            wanted = [result[: i + 1] for i in range(len(result))]
            came = [numbers(feedback) for feedback in pursuit.feedback]
            if came == wanted:
                continue
            expected, seen = apart(wanted, came)
            raise Fail(
                f'{len(wanted)} feedbacks: {expected}',
                f'{len(came)} feedbacks: {seen}',
                next((m for m in mistakes if m.model and m.model(result) == came), None),
            )

    return rule
