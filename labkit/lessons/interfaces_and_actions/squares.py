"""Exercise: an action server with feedback and a result."""

from __future__ import annotations

import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Fail, Outcome, Solution, Style, Wrong, changed, expect
from labkit.exercises.clauses import Goal, Pursues, Pursuit, Serves
from labkit.lessons._script import in_process
from labkit.lessons.interfaces_and_actions._rules import (
    ACTION,
    expect_ending,
    expect_numbers,
    numbers,
    own_executor,
)

__all__ = ['squares']

NAME = '/squares'

_SQUARES = """
from rclpy.action import ActionServer
from rclpy.node import Node
from test_msgs.action import Fibonacci


class Squares(Node):
    def __init__(self):
        super().__init__('squares')
        self.server = ActionServer(self, Fibonacci, 'squares', self.execute)

    def execute(self, goal_handle):
        numbers = []
        for i in range(goal_handle.request.order):
            numbers.append(i * i)
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        goal_handle.succeed()
        return Fibonacci.Result(sequence=numbers)


lab.spin(Squares())
"""
_FUNCTIONS = """
from rclpy.action import ActionServer
from rclpy.node import Node
from test_msgs.action import Fibonacci

node = Node('calculator_of_squares')


def square_numbers(handle):
    result, feedback = Fibonacci.Result(), Fibonacci.Feedback()
    while len(result.sequence) < handle.request.order:
        result.sequence.append(len(result.sequence) ** 2)
        feedback.sequence = result.sequence
        handle.publish_feedback(feedback)
    handle.succeed()
    return result


ActionServer(node, Fibonacci, '/squares', square_numbers)
lab.spin(node)
"""
_FEEDBACK = '            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))\n'
_RESULT = 'return Fibonacci.Result(sequence=numbers)'


def _draw() -> list[Goal]:
    # The same one twice, and a shorter one after a longer one.
    order = random.randint(4, 6)
    return [Goal({'order': n}) for n in (order, order, random.randint(1, 3))]


def _squares(pursuit: Pursuit) -> list[int]:
    return [i * i for i in range(pursuit.goal.fields['order'])]


def _result(pursuits: Sequence[Pursuit]) -> None:
    before: list[int] = []
    for pursuit in pursuits:
        expect_ending(pursuit, 'succeeded')
        wanted = _squares(pursuit)
        expect_numbers(pursuit, wanted, numbers(pursuit.result), before, 'result')
        before = wanted


def _feedback(pursuits: Sequence[Pursuit]) -> None:
    for pursuit in pursuits:
        expect_ending(pursuit, 'succeeded')
        squares = _squares(pursuit)
        wanted = [squares[: i + 1] for i in range(len(squares))]
        came = [numbers(feedback) for feedback in pursuit.feedback]
        if came == wanted:
            continue
        why, todo = 'The feedback is another one.', 'Compare it with that of the task.'
        if not came:
            why = 'Nobody has published feedback.'
            todo = 'In the loop: goal_handle.publish_feedback(Fibonacci.Feedback(sequence=...))'
        elif came == [[number] for number in squares]:
            why = 'Each feedback has the newest number alone.'
            todo = 'Put all numbers so far into it.'
        elif len(came) == 1:
            why = 'There is one feedback, at the end. Then nobody needs it any more.'
            todo = 'Publish it in the loop, after each number.'
        raise Fail(
            f'{len(wanted)} feedbacks: {expect.show(wanted)}',
            f'{len(came)} feedbacks: {expect.show(came)}',
            why=why,
            todo=todo,
        )


squares = Exercise(
    name='squares',
    task='Serve the action /squares: the first squares, with feedback and a result.',
    serves={NAME: ACTION},
    clauses=(
        Serves(NAME, ACTION),
        Pursues(
            NAME,
            'each goal succeeds, and its result is the first `order` squares: 0, 1, 4 and so on',
            _draw,
            _result,
        ),
        Pursues(NAME, 'one feedback for each number, with all numbers so far', _draw, _feedback),
    ),
    hints=[
        'The class Fibonacci of this lesson has all parts that you need. No timer is needed here.',
        'ActionServer(self, Fibonacci, name, self.execute); the callback gets a goal handle.',
        'goal_handle.request.order, goal_handle.publish_feedback(...), goal_handle.succeed(), '
        'return Fibonacci.Result(sequence=numbers)',
    ],
    answer=Solution(
        _SQUARES,
        'The callback gets a handle of the goal: it has the request, publishes feedback, and says '
        'how the goal has ended. What the callback returns is the result.',
    ),
    styles=[
        Style('functions', _FUNCTIONS),
        Style('async', changed(_SQUARES, ('    def execute', '    async def execute'))),
        Style('own process', in_process(_SQUARES), process=True),
        Style('own process, several threads', own_executor(in_process(_SQUARES)), process=True),
    ],
    wrong=[
        Wrong(
            'another name',
            changed(_SQUARES, ("Fibonacci, 'squares'", "Fibonacci, 'square'")),
            "Write the name as '/squares'",
        ),
        Wrong(
            'not ended',
            changed(_SQUARES, ('        goal_handle.succeed()\n', '')),
            'had not said how the goal ended',
        ),
        Wrong(
            'aborted on purpose',
            changed(_SQUARES, ('goal_handle.succeed()', 'goal_handle.abort()')),
            'it was aborted',
        ),
        Wrong(
            'from 1 on', changed(_SQUARES, ('i * i', '(i + 1) ** 2')), 'The numbers are others.'
        ),
        Wrong('cubes', changed(_SQUARES, ('i * i', 'i**3')), 'The numbers are others.'),
        Wrong(
            'one too many',
            changed(_SQUARES, ('request.order)', 'request.order + 1)')),
            'result = ',
        ),
        Wrong(
            'an empty result',
            changed(_SQUARES, (_RESULT, 'return Fibonacci.Result()')),
            'The result is empty.',
        ),
        Wrong(
            'numbers that stay',
            changed(
                _SQUARES,
                ('        numbers = []\n', '        numbers = self.numbers\n'),
                ("__init__('squares')\n", "__init__('squares')\n        self.numbers = []\n"),
            ),
            'The numbers of the goal before are still there.',
        ),
        Wrong('no feedback', changed(_SQUARES, (_FEEDBACK, '')), 'Nobody has published feedback.'),
        Wrong(
            'the newest number as feedback',
            changed(_SQUARES, ('Feedback(sequence=numbers)', 'Feedback(sequence=numbers[-1:])')),
            'Each feedback has the newest number alone.',
        ),
        Wrong(
            'a field that does not exist',
            changed(_SQUARES, ('request.order', 'request.count')),
            'AttributeError',
            outcome=Outcome.ERROR,
        ),
    ],
)
