"""Exercise: an action server that rejects goals."""

from __future__ import annotations

import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Goal, Pursues, Pursuit, Serves
from labkit.lessons._script import in_process
from labkit.lessons.interfaces_and_actions._rules import (
    ACTION,
    expect_ending,
    expect_numbers,
    numbers,
    own_executor,
)

__all__ = ['stairs']

NAME = '/stairs'

_STAIRS = """
from rclpy.action import ActionServer, GoalResponse
from rclpy.node import Node
from test_msgs.action import Fibonacci


class Stairs(Node):
    def __init__(self):
        super().__init__('stairs')
        self.server = ActionServer(self, Fibonacci, 'stairs', self.execute)
        self.server.register_goal_callback(self.on_goal)

    def on_goal(self, goal):
        if 1 <= goal.order <= 20:
            return GoalResponse.ACCEPT
        return GoalResponse.REJECT

    def execute(self, goal_handle):
        goal_handle.succeed()
        return Fibonacci.Result(sequence=range(1, goal_handle.request.order + 1))


lab.spin(Stairs())
"""
_SERVER = """        self.server = ActionServer(self, Fibonacci, 'stairs', self.execute)
        self.server.register_goal_callback(self.on_goal)
"""
_KEYWORD = """        self.server = ActionServer(
            self, Fibonacci, 'stairs', self.execute, goal_callback=self.on_goal
        )
"""
_REGISTER = '        self.server.register_goal_callback(self.on_goal)\n'
_TEST = '1 <= goal.order <= 20'
_ON_GOAL = """        if 1 <= goal.order <= 20:
            return GoalResponse.ACCEPT
        return GoalResponse.REJECT
"""


def _draw_goals() -> list[Goal]:
    inside, outside = [1, 20, random.randint(2, 19)], [0, 21, -1, random.randint(22, 99)]
    return [Goal({'order': order}) for order in random.sample([*inside, *outside], k=7)]


def _accepts(pursuits: Sequence[Pursuit]) -> None:
    for pursuit in sorted(pursuits, key=lambda pursuit: abs(pursuit.goal.fields['order'] - 10)):
        inside = 1 <= pursuit.goal.fields['order'] <= 20
        if inside == pursuit.accepted:
            continue
        expect_ending(pursuit, 'succeeded' if inside else 'rejected')


def _draw() -> list[Goal]:
    return [Goal({'order': n}) for n in (random.randint(5, 9), random.randint(2, 4), 1)]


def _result(pursuits: Sequence[Pursuit]) -> None:
    before: list[int] = []
    for pursuit in pursuits:
        expect_ending(pursuit, 'succeeded')
        wanted = list(range(1, pursuit.goal.fields['order'] + 1))
        expect_numbers(pursuit, wanted, numbers(pursuit.result), before, 'result')
        before = wanted


stairs = Exercise(
    name='stairs',
    task='Serve the action /stairs, which rejects some goals.',
    serves={NAME: ACTION},
    clauses=(
        Serves(NAME, ACTION),
        Pursues(
            NAME,
            'a goal whose `order` is from 1 to 20 is accepted, any other one is rejected',
            _draw_goals,
            _accepts,
        ),
        Pursues(
            NAME,
            'an accepted goal succeeds, and its result is the numbers from 1 to `order`',
            _draw,
            _result,
        ),
    ),
    hints=[
        'A callback of its own is asked before a goal is accepted.',
        'ActionServer(..., goal_callback=self.on_goal); it gets the goal, and no handle.',
        'return GoalResponse.ACCEPT or GoalResponse.REJECT, from rclpy.action',
    ],
    answer=Solution(
        _STAIRS,
        'goal_callback is asked before anything is done. Who is rejected learns it at once, and '
        'execute is not called.',
    ),
    styles=[
        Style(
            'lambda',
            changed(
                _STAIRS,
                (
                    '(self.on_goal)',
                    '(lambda goal: GoalResponse(1 + (0 < goal.order < 21)))',
                ),
                (f'    def on_goal(self, goal):\n{_ON_GOAL}\n', ''),
            ),
        ),
        Style('a keyword', changed(_STAIRS, (_SERVER, _KEYWORD))),
        Style('own process', in_process(_STAIRS), process=True),
        Style('own process, several threads', own_executor(in_process(_STAIRS)), process=True),
    ],
    wrong=[
        Wrong(
            'another name',
            changed(_STAIRS, ("Fibonacci, 'stairs'", "Fibonacci, 'stair'")),
            "Write the name as '/stairs'",
        ),
        Wrong(
            'no goal_callback',
            changed(_STAIRS, (_REGISTER, '')),
            'Without one, all are.',
        ),
        Wrong('all rejected', changed(_STAIRS, (_TEST, 'goal.order > 99')), 'it was rejected'),
        Wrong('20 rejected', changed(_STAIRS, ('<= 20', '< 20')), 'order = 20 is succeeded'),
        Wrong('1 rejected', changed(_STAIRS, ('1 <=', '1 <')), 'order = 1 is succeeded'),
        Wrong('0 accepted', changed(_STAIRS, ('1 <=', '0 <=')), 'order = 0 is rejected'),
        Wrong('no lower limit', changed(_STAIRS, (_TEST, 'goal.order <= 20')), 'is rejected'),
        Wrong(
            'True in the place of ACCEPT',
            changed(_STAIRS, (_ON_GOAL, f'        return {_TEST}\n')),
            'goal_callback did not return GoalResponse.ACCEPT',
        ),
        Wrong(
            'refused too late',
            changed(
                _STAIRS,
                (_REGISTER, ''),
                (
                    '        goal_handle.succeed()\n',
                    '        if not 1 <= goal_handle.request.order <= 20:\n'
                    '            goal_handle.abort()\n'
                    '            return Fibonacci.Result()\n'
                    '        goal_handle.succeed()\n',
                ),
            ),
            'is rejected',
        ),
        Wrong(
            'one number too few',
            changed(_STAIRS, ('order + 1', 'order')),
            'result = ',
        ),
        Wrong(
            'from 0 on',
            changed(_STAIRS, ('range(1, ', 'range(')),
            'The numbers are others.',
        ),
        Wrong(
            'a typing error in goal_callback',
            changed(_STAIRS, ('1 <= goal.order', '1 <= goal.ordr')),
            'AttributeError',
            outcome=Outcome.ERROR,
        ),
    ],
)
