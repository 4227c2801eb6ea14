"""Exercise: an action client that does not wait for itself."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from labkit.exercises import Exercise, Fail, Outcome, Solution, Style, Wrong, changed, expect
from labkit.exercises.clauses import Answers, Clause, Evidence, Named
from labkit.lessons._script import in_process
from labkit.lessons.interfaces_and_actions._rules import ACTION, own_executor

__all__ = ['asker']

WISH, SUM, NAME = '/wish', '/sum', '/add_up'
INT16, INT32 = 'std_msgs/msg/Int16', 'std_msgs/msg/Int32'
NODE = '/asker'
CELL = 'calculator = lab.spin(make_calculator())'

_ASKER = """
from rclpy.action import ActionClient
from rclpy.node import Node
from std_msgs.msg import Int16, Int32
from test_msgs.action import Fibonacci


class Asker(Node):
    def __init__(self):
        super().__init__('asker')
        self.client = ActionClient(self, Fibonacci, 'add_up')
        self.publisher = self.create_publisher(Int32, 'sum', 10)
        self.subscription = self.create_subscription(Int16, 'wish', self.on_wish, 10)

    def on_wish(self, msg):
        future = self.client.send_goal_async(Fibonacci.Goal(order=msg.data))
        future.add_done_callback(self.on_accepted)

    def on_accepted(self, future):
        future.result().get_result_async().add_done_callback(self.on_result)

    def on_result(self, future):
        self.publisher.publish(Int32(data=future.result().result.sequence[-1]))


lab.spin(Asker())
"""
_CALLBACKS = _ASKER[_ASKER.index('    def on_wish') : _ASKER.index('\n\nlab.spin')]
_LAMBDAS = """    def on_wish(self, msg):
        sent = self.client.send_goal_async(Fibonacci.Goal(order=msg.data))
        sent.add_done_callback(
            lambda done: done.result().get_result_async().add_done_callback(self.say)
        )

    def say(self, done):
        result = done.result().result
        self.publisher.publish(Int32(data=result.sequence[-1]))
"""
_AWAIT = """    async def on_wish(self, msg):
        handle = await self.client.send_goal_async(Fibonacci.Goal(order=msg.data))
        answer = await handle.get_result_async()
        self.publisher.publish(Int32(data=answer.result.sequence[-1]))
"""
_SYNCHRONOUS = """    def on_wish(self, msg):
        answer = self.client.send_goal(Fibonacci.Goal(order=msg.data))
        self.publisher.publish(Int32(data=answer.result.sequence[-1]))
"""
_GROUP = """ActionClient(
            self, Fibonacci, 'add_up', callback_group=MutuallyExclusiveCallbackGroup()
        )"""
_GROUPED = (
    ("ActionClient(self, Fibonacci, 'add_up')", _GROUP),
    (
        'from rclpy.node import Node\n',
        'from rclpy.callback_groups import MutuallyExclusiveCallbackGroup\n'
        'from rclpy.node import Node\n',
    ),
)


def _calculator(evidence: Evidence) -> Any:
    """Return the calculator of this notebook; raise Fail if it is not there."""
    from labkit.lessons.interfaces_and_actions.calculator import is_calculator

    found = evidence.probe.node_object('/calculator')
    expect.that(
        is_calculator(found) and found.executor is not None,
        expected=f'the calculator of this lesson, which serves {NAME}',
        seen='no calculator',
        why='Your node is there, and what it should ask is not.',
        todo=f'Run the cell again that says: {CELL}',
    )
    return found


def _answer(order: int) -> int:
    from labkit.exercises.callbacks import find_node

    return int(find_node('/calculator').factor) * order * (order + 1) // 2


def _draw() -> list[int]:
    # More than ten, of which two are the same.
    return [3, 3, *random.sample(range(1, 60), k=10)]


@dataclass(frozen=True)
class _Sends(Clause):
    """A goal is sent for each message, with its number."""

    @property
    def text(self) -> str:
        """What is asked for."""
        return (
            f'for each message on `{WISH}` (`{INT16}`), send one goal to `{NAME}` (`{ACTION}`), '
            'with its `data` as `order`'
        )

    def find(self, evidence: Evidence) -> None:
        """Look for the subscription and the calculator, and give that another factor."""
        evidence.subscription(WISH, NODE)
        _calculator(evidence).factor = random.randint(2, 9)

    def tests(self, evidence: Evidence) -> Sequence[Any]:
        """Count the goals from now on. The tests are those of the answers."""
        _calculator(evidence).orders.clear()
        return ()

    def judge(self, evidence: Evidence) -> str:
        """Compare what was heard with what was sent."""
        heard = [sample.message.data for sample in evidence.life.on(WISH)]
        orders = _calculator(evidence).orders
        evidence.probe.wait(lambda: len(orders) >= len(heard), 1.0)
        if orders == heard:
            return f'{len(heard)} messages, {len(orders)} goals.'
        expect.hanging()
        expect.spun(evidence.probe, evidence.subscription(WISH, NODE))
        why, todo = 'The goals are others.', 'Fibonacci.Goal(order=msg.data)'
        if not orders:
            why = 'No goal has come to the calculator.'
            todo = 'In the callback of the subscription: self.client.send_goal_async(goal)'
        elif len(orders) > len(heard):
            why = 'More goals are sent than messages come.'
            todo = 'Send one goal in the callback, and nowhere else.'
        elif len(orders) < len(heard):
            why = 'Some messages lead to a goal, and others do not.'
            todo = 'Send a goal for each message, also for a number that came before.'
        raise Fail(
            f'goals with order = {expect.show(heard)}',
            f'{len(orders)} goals with order = {expect.show(list(orders))}',
            why=why,
            todo=todo,
        )


def _explain(order: int, came: Sequence[int]) -> tuple[str, str]:
    if not came:
        return (
            'A goal was sent, and nothing was published when its result came.',
            'on_accepted asks for the result: handle.get_result_async().add_done_callback(...)',
        )
    return (
        'That is not the last number of the result. The calculator may use another factor now.',
        'Publish future.result().result.sequence[-1], of the goal of this message.',
    )


asker = Exercise(
    name='asker',
    task='Send a goal to /add_up for each Int16 on /wish, and publish the last number of each '
    'result on /sum.',
    publishes={SUM: INT32},
    subscribes={WISH: INT16},
    nodes=[NODE],
    clauses=(
        Named(NODE),
        _Sends(),
        Answers(
            WISH,
            SUM,
            f'publish the last number of each result on `{SUM}` (`{INT32}`), once, within a '
            'second',
            answer=_answer,
            draw=_draw,
            by=NODE,
            explain=_explain,
        ),
    ),
    hints=[
        'Nothing may wait here. There are two answers to wait for: accepted, and the result.',
        'send_goal_async(...).add_done_callback(self.on_accepted); its result is a goal handle.',
        'handle.get_result_async().add_done_callback(self.on_result); there, '
        'future.result().result.sequence[-1]',
    ],
    answer=Solution(
        _ASKER,
        'Three short callbacks, and each of them returns: a wish comes, the goal is accepted, the '
        'result is there.',
    ),
    styles=[
        Style('lambda', changed(_ASKER, (_CALLBACKS, _LAMBDAS))),
        Style('await', changed(_ASKER, (_CALLBACKS, _AWAIT), *_GROUPED)),
        Style('own process', in_process(_ASKER), process=True),
        Style(
            'own process, several threads, and send_goal()',
            own_executor(in_process(changed(_ASKER, (_CALLBACKS, _SYNCHRONOUS), *_GROUPED))),
            process=True,
        ),
    ],
    wrong=[
        Wrong(
            'send_goal() in the callback',
            changed(_ASKER, (_CALLBACKS, _SYNCHRONOUS)),
            'inside a callback would wait for ever',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'another node',
            changed(_ASKER, ("__init__('asker')", "__init__('asking')")),
            'a node called /asker',
        ),
        Wrong(
            'no goal',
            changed(
                _ASKER,
                (
                    'future = self.client.send_goal_async(Fibonacci.Goal(order=msg.data))\n'
                    '        future.add_done_callback(self.on_accepted)\n',
                    'self.order = msg.data\n',
                ),
            ),
            'No goal has come to the calculator.',
        ),
        Wrong(
            'another number',
            changed(_ASKER, ('order=msg.data', 'order=msg.data + 1')),
            'The goals are others.',
        ),
        Wrong(
            'two goals',
            changed(
                _ASKER,
                (
                    '        future = self',
                    '        self.client.send_goal_async(Fibonacci.Goal(order=msg.data))\n'
                    '        future = self',
                ),
            ),
            'More goals are sent than messages come.',
        ),
        Wrong(
            'small numbers only',
            changed(
                _ASKER,
                (
                    '        future = self',
                    '        if msg.data == 3:\n            return\n        future = self',
                ),
            ),
            'Some messages lead to a goal, and others do not.',
        ),
        Wrong(
            'the result is not asked for',
            changed(
                _ASKER,
                (
                    'future.result().get_result_async().add_done_callback(self.on_result)',
                    'self.goal = future.result()',
                ),
            ),
            'nothing was published when its result came',
        ),
        Wrong(
            'the first number',
            changed(_ASKER, ('sequence[-1]', 'sequence[0]')),
            'That is not the last number of the result.',
        ),
        Wrong(
            'adds up itself',
            changed(
                _ASKER,
                ('future.result().result.sequence[-1]', 'sum(range(4))'),
            ),
            'That is not the last number of the result.',
        ),
        Wrong(
            'takes the handle for the result',
            changed(
                _ASKER,
                (
                    'future.result().get_result_async().add_done_callback(self.on_result)',
                    'self.on_result(future)',
                ),
            ),
            'AttributeError',
            outcome=Outcome.ERROR,
        ),
    ],
)
