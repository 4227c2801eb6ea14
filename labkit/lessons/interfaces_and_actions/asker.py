"""Exercise: an action client that does not wait for itself."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

from labkit.exercises import Exercise, Fail, Mistake, Solution, anything, expect
from labkit.exercises.callbacks import find_node
from labkit.exercises.clauses import WITHIN, Answers, Evidence, GraphClause, Named
from labkit.exercises.draws import MANY
from labkit.lessons.interfaces_and_actions.calculator import is_calculator
from labkit.lessons.interfaces_and_actions.goals import ACTION

__all__ = ['asker']

WISH, SUM, NAME = '/wish', '/sum', '/add_up'
INT16, INT32 = 'std_msgs/msg/Int16', 'std_msgs/msg/Int32'
NODE = '/asker'

NO_CALCULATOR = Mistake(
    'asker/no-calculator',
    'Your node is there, and what it should ask is not.',
    'Run the cell again that says: calculator = lab.spin(make_calculator())',
)
_SEND = '        future = self'
NO_GOAL = Mistake(
    'asker/no-goal',
    'No goal has come to the calculator.',
    'In the callback of the subscription: self.client.send_goal_async(goal)',
    change=[
        (
            'future = self.client.send_goal_async(Fibonacci.Goal(order=msg.data))\n'
            '        future.add_done_callback(self.on_accepted)\n',
            'self.order = msg.data\n',
        ),
    ],
)
TWO_GOALS = Mistake(
    'asker/two-goals',
    'More goals are sent than messages come.',
    'Send one goal in the callback, and nowhere else.',
    change=[
        (
            _SEND,
            f'        self.client.send_goal_async(Fibonacci.Goal(order=msg.data))\n{_SEND}',
        ),
    ],
)
SOME_GOALS = Mistake(
    'asker/some-goals',
    'Some messages lead to a goal, and others do not.',
    'Send a goal for each message, also for a number that came before.',
    change=[(_SEND, f'        if msg.data == 3:\n            return\n{_SEND}')],
)
OTHER_GOALS = Mistake(
    'asker/other-goals',
    'The goals are not those of the messages.',
    'Fibonacci.Goal(order=msg.data)',
    change=[('order=msg.data', 'order=msg.data + 1')],
)
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


class _Sends(GraphClause):
    text = (
        f'for each message on `{WISH}` (`{INT16}`), send one goal to `{NAME}` (`{ACTION}`), '
        'with its `data` as `order`'
    )

    def find(self, evidence: Evidence) -> None:
        evidence.subscription(WISH, NODE)
        found = find_node('/calculator')
        expect.that(
            is_calculator(found) and found.executor is not None,
            expected=f'the calculator of this lesson, which serves {NAME}',
            seen='no calculator',
            mistake=NO_CALCULATOR,
        )
        expect.only_given(evidence.probe, NAME, '/calculator')
        expect.asks(evidence.probe, NODE, NAME)
        evidence.partners.add('/calculator')
        # With some of them the last sum is the least one.
        found.factor = random.choice((-1, 1)) * random.randint(2, 9)

    def tests(self, evidence: Evidence) -> Sequence[Any]:
        # Those of the answers; the goals are counted from now on.
        find_node('/calculator').orders.clear()
        return ()

    def judge(self, evidence: Evidence) -> str:
        heard = [sample.message.data for sample in evidence.life.on(WISH)]
        orders = find_node('/calculator').orders
        evidence.probe.wait(lambda: len(orders) >= len(heard), 1.0)
        if orders == heard:
            return f'{len(heard)} messages, {len(orders)} goals.'
        expect.hanging()
        expect.spun(evidence.probe, evidence.subscription(WISH, NODE))
        mistake = OTHER_GOALS if orders else NO_GOAL
        if orders and len(orders) != len(heard):
            mistake = TWO_GOALS if len(orders) > len(heard) else SOME_GOALS
        expected, seen = expect.apart(heard, list(orders))
        raise Fail(
            f'{len(heard)} goals with order = {expected}',
            f'{len(orders)} goals with order = {seen}',
            mistake,
        )


asker = Exercise(
    name='asker',
    task='Send a goal to /add_up for each Int16 on /wish, and publish the last number of each '
    'result on /sum.',
    clauses=(
        Named(NODE),
        _Sends(),
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
