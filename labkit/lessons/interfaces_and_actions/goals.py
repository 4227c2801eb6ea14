"""What becomes of the goals that the checks of this lesson send, and what is often wrong."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from labkit.exercises import Fail, Mistake
from labkit.exercises.clauses import Goal, Pursuit
from labkit.exercises.expect import apart

__all__ = [
    'ACTION',
    'expect_ending',
    'expect_result',
    'feedbacks',
    'fibonacci_goals',
    'numbers',
    'order_of',
    'results',
]

ACTION = 'test_msgs/action/Fibonacci'
# A goal with a larger order may take long.
LONG = 6
Numbers = list[int]
Rule = Callable[[Sequence[Pursuit]], None]

NOT_SAID = Mistake(
    'goals/aborted',
    'execute_callback returned without saying how the goal ended, so it was aborted.',
    'Call goal_handle.{method}() before return.',
)
RAISED = Mistake(
    'goals/raised',
    'execute_callback raised an error, so the goal was aborted.',
    'Look at the output of its program: the error is there.',
)
SAID_ABORT = Mistake(
    'goals/said-abort',
    'execute_callback said abort(): that is for a goal that can not be reached.',
    'Call goal_handle.{method}() in its place.',
)
REJECTED = Mistake(
    'goals/rejected',
    'goal_callback did not return GoalResponse.ACCEPT for it.',
    'Return GoalResponse.ACCEPT or GoalResponse.REJECT, from rclpy.action.',
)
CANCEL_REJECTED = Mistake(
    'goals/cancel-rejected',
    'The request to cancel was rejected, as it is without a cancel_callback.',
    'ActionServer(..., cancel_callback=...) that returns CancelResponse.ACCEPT',
)
_LOOK = 'In its loop: if goal_handle.is_cancel_requested, goal_handle.canceled() and return.'
GOES_ON = Mistake(
    'goals/goes-on',
    'Accepting a request to cancel does not end the goal. execute_callback has to look.',
    _LOOK,
)
SAID_SUCCEED = Mistake(
    'goals/said-succeed',
    'It stopped on its way, and said succeed(). A goal that was called off ends otherwise.',
    'Call goal_handle.canceled() before return.',
)
OTHER_ENDING = Mistake(
    'goals/other-ending', 'A goal with order = {order} has to be {wanted}.', 'Compare the limits.'
)
EMPTY = Mistake(
    'goals/empty', 'The result is empty.', 'Put the numbers in: Fibonacci.Result(sequence=...)'
)
STILL_THERE = Mistake(
    'goals/still-there',
    'The numbers of the goal before are still there.',
    'Begin with a new list in execute_callback, and not in __init__.',
)
OTHERS = Mistake(
    'goals/others', 'The numbers are not those of the task.', 'Compare them one by one.'
)


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
