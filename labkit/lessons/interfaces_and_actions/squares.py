"""Exercise: an action server with feedback and a result."""

from __future__ import annotations

import random

from labkit.exercises import Exercise, Mistake, Solution, anything
from labkit.exercises.clauses import Goal, Pursues, Serves
from labkit.lessons.interfaces_and_actions.goals import ACTION, feedbacks, goals, results

__all__ = ['squares']

NAME = '/squares'
_PUBLISH = 'goal_handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))\n'
_SUCCEED = 'goal_handle.succeed()\n'

MISTAKES = (
    Mistake(
        'squares/no-feedback',
        'No feedback was published.',
        'In the loop: goal_handle.publish_feedback(Fibonacci.Feedback(sequence=...))',
        model=lambda squares: [],
        change=[(f'            {_PUBLISH}', '')],
    ),
    Mistake(
        'squares/newest-alone',
        'Each feedback has the newest number alone.',
        'Put all numbers so far into it.',
        model=lambda squares: [[square] for square in squares],
        change=[('Feedback(sequence=numbers)', 'Feedback(sequence=numbers[-1:])')],
    ),
    Mistake(
        'squares/one-at-the-end',
        'There is one feedback, at the end. Then nobody needs it any more.',
        'Publish it in the loop, after each number.',
        model=lambda squares: [squares],
        change=[
            (f'            {_PUBLISH}        {_SUCCEED}', f'        {_PUBLISH}        {_SUCCEED}')
        ],
    ),
    Mistake(
        'squares/other-feedback',
        'The feedback is not that of the task.',
        'Compare it with that of the task.',
        model=anything,
    ),
)


def _squares(order: int) -> list[int]:
    return [i * i for i in range(order)]


def _draw() -> list[Goal]:
    # The same one twice, a shorter one after a longer one, the shortest ones, and a long one.
    order = random.randint(4, 6)
    return goals(order, order, random.randint(2, 3), 0, 1, random.randint(60, 90))


squares = Exercise(
    name='squares',
    task='Serve the action /squares: the first squares, with feedback and a result.',
    clauses=(
        Serves(NAME, ACTION),
        Pursues(
            NAME,
            'each goal succeeds, and its result is the first `order` squares: '
            f'{", ".join(map(str, _squares(3)))} and so on',
            _draw,
            results(_squares),
        ),
        Pursues(
            NAME,
            'one feedback for each number, with all numbers so far',
            _draw,
            feedbacks(_squares, MISTAKES),
        ),
    ),
    mistakes=MISTAKES,
    hints=[
        'The class Fibonacci of this lesson has all parts that you need. No timer is needed here.',
        'ActionServer(self, Fibonacci, name, self.execute); the callback gets a goal handle.',
        'goal_handle.request.order, goal_handle.publish_feedback(...), goal_handle.succeed(), '
        'return Fibonacci.Result(sequence=numbers)',
    ],
    answer=Solution(
        __file__,
        'squares.py',
        'The callback gets a handle of the goal: it has the request, publishes feedback, and says '
        'how the goal has ended. What the callback returns is the result.',
    ),
)
