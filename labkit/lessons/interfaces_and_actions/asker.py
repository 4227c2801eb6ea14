"""Exercise: an action client that does not wait for itself."""

from __future__ import annotations

import random
from typing import Any

from labkit.exercises import Exercise, Mistake, Solution, anything
from labkit.exercises.callback_count import find_node
from labkit.exercises.clauses import WITHIN, Answers, AsksForEach, Named
from labkit.exercises.draws import MANY
from labkit.lessons.interfaces_and_actions.goals import ACTION

__all__ = ['exercise']

WISH, SUM, NAME = '/wish', '/sum', '/add_up'
INT16, INT32 = 'std_msgs/msg/Int16', 'std_msgs/msg/Int32'
NODE = '/asker'

NOT_ASKED = Mistake(
    'asker/the-result-is-not-asked-for',
    'A goal was sent, but nothing was published when its result came.',
    'on_accepted asks for the result: handle.get_result_async().add_done_callback(...)',
    change=[
        (
            'future.result().get_result_async().add_done_callback(self.on_result)',
            'self.goal = future.result()',
        ),
    ],
)
OTHER_NUMBER = Mistake(
    'asker/the-first-number',
    'That is not the last number of the result. The calculator may use another factor now.',
    'Publish future.result().result.sequence[-1], of the goal of this message.',
    model=anything,
    change=[('sequence[-1]', 'sequence[0]')],
)


def _change(calculator: Any) -> None:
    # With some factors the last sum is the least one.
    calculator.factor = random.choice((-1, 1)) * random.randint(2, 9)


exercise = Exercise(
    name='asker',
    task='Send a goal to /add_up for each Int16 on /wish, and publish the last number of each '
    'result on /sum.',
    clauses=(
        Named(NODE),
        AsksForEach(
            WISH,
            NODE,
            NAME,
            partner='/calculator',
            cell='calculator = lab.spin(make_calculator())',
            words=f'for each message on `{WISH}` (`{INT16}`), send one goal to `{NAME}` '
            f'(`{ACTION}`), with its `data` as `order`',
            request='Fibonacci.Goal(order=msg.data)',
            change=_change,
            is_action=True,
        ),
        Answers(
            WISH,
            SUM,
            INT16,
            f'publish the last number of each result on `{SUM}` (`{INT32}`), once, {WITHIN}',
            answer=lambda order: int(find_node('/calculator').factor) * order * (order + 1) // 2,
            # Many, of which two are the same, with the smallest one and a large one.
            draw=lambda: [3, 3, 1, random.randint(200, 300), *random.sample(range(2, 60), k=MANY)],
            outer_type=INT32,
            by=NODE,
            mistakes=[OTHER_NUMBER],
            explain=lambda order, came: NOT_ASKED,
        ),
    ),
    hints=[
        'Nothing may wait here. There are two answers to wait for: accepted, and the result.',
        'send_goal_async(...).add_done_callback(self.on_accepted); its result is a goal handle.',
        'handle.get_result_async().add_done_callback(self.on_result); there, '
        'future.result().result.sequence[-1]',
    ],
    answer=Solution(
        __file__,
        'asker.py',
        'Three short callbacks, and each of them returns: a wish comes, the goal is accepted, the '
        'result is there.',
    ),
)
