"""What the checks of this lesson say of the goals that they have sent."""

from __future__ import annotations

from collections.abc import Sequence

from labkit.exercises import Fail, expect
from labkit.exercises.clauses import Pursuit

__all__ = ['ACTION', 'expect_ending', 'numbers', 'own_executor']

ACTION = 'test_msgs/action/Fibonacci'


def numbers(message: object) -> list[int]:
    """Return the numbers of a result or a feedback."""
    return [int(number) for number in getattr(message, 'sequence', ())]


def expect_ending(pursuit: Pursuit, wanted: str) -> None:
    """Raise Fail unless a goal came to the end that was wanted.

    Args:
        pursuit: What has become of the goal.
        wanted: `'succeeded'`, `'canceled'` or `'rejected'`.
    """
    if pursuit.ending == wanted:
        return
    order = pursuit.goal.fields['order']
    why, todo = f'A goal with order = {order} has to be {wanted}.', ''
    if pursuit.ending == 'aborted':
        why = 'execute_callback returned, and had not said how the goal ended: then it is aborted.'
        todo = f'Call goal_handle.{wanted if wanted == "canceled" else "succeed"}() before return.'
    elif pursuit.ending == 'rejected':
        why = 'goal_callback did not return GoalResponse.ACCEPT for it.'
        todo = 'Return GoalResponse.ACCEPT or GoalResponse.REJECT, from rclpy.action.'
    elif wanted == 'rejected':
        why = 'goal_callback is asked first whether a goal is accepted. Without one, all are.'
        todo = 'ActionServer(..., goal_callback=self.on_goal)'
    elif pursuit.cancel_accepted is False:
        why = 'The request to cancel was rejected, as it is without a cancel_callback.'
        todo = 'ActionServer(..., cancel_callback=...) that returns CancelResponse.ACCEPT'
    elif wanted == 'canceled':
        why = 'To accept a request to cancel ends nothing. execute_callback has to look.'
        todo = (
            'In its loop: if goal_handle.is_cancel_requested, goal_handle.canceled() and return.'
        )
    raise Fail(
        f'the goal with order = {order} is {wanted}',
        f'it was {pursuit.ending}',
        why=why,
        todo=todo,
    )


def expect_numbers(
    pursuit: Pursuit, wanted: Sequence[int], seen: Sequence[int], before: Sequence[int], what: str
) -> None:
    """Raise Fail unless the numbers are those that were wanted.

    Args:
        pursuit: What has become of the goal.
        wanted: The numbers.
        seen: Those that came.
        before: The numbers of the goal before.
        what: Where they came, such as `'result'`.
    """
    if list(seen) == list(wanted):
        return
    why, todo = 'The numbers are others.', 'Compare them with those of the task, one by one.'
    if not seen:
        why = f'The {what} is empty.'
        todo = f'Put the numbers into it: Fibonacci.{what.capitalize()}(sequence=...)'
    elif before and list(seen[: len(before)]) == list(before) and len(seen) > len(wanted):
        why = 'The numbers of the goal before are still there.'
        todo = 'Begin with a new list in execute_callback, and not in __init__.'
    raise Fail(
        f'{what} = {expect.show(list(wanted))} for order = {pursuit.goal.fields["order"]}',
        f'{what} = {expect.show(list(seen))}',
        why=why,
        todo=todo,
    )


def own_executor(script: str) -> str:
    """Return a script whose node is spun by an executor with several threads."""
    node = script.partition('rclpy.spin(')[2].rpartition('))')[0] + ')'
    return script.replace(
        f'rclpy.spin({node})',
        f'executor = MultiThreadedExecutor()\n    executor.add_node({node})\n    executor.spin()',
    ).replace(
        'from rclpy.node import Node\n',
        'from rclpy.executors import MultiThreadedExecutor\nfrom rclpy.node import Node\n',
    )
