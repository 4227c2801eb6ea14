"""Exercise: an action server whose goals can be canceled on the way."""

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

__all__ = ['countdown']

NAME = '/countdown'

_COUNTDOWN = """
from rclpy.action import ActionServer, CancelResponse
from rclpy.node import Node
from rclpy.task import Future
from test_msgs.action import Fibonacci


class Countdown(Node):
    def __init__(self):
        super().__init__('countdown')
        self.server = ActionServer(self, Fibonacci, 'countdown', self.execute)
        self.server.register_cancel_callback(self.on_cancel)
        self.tick = Future()
        self.timer = self.create_timer(0.05, self.on_timer)

    def on_timer(self):
        self.tick.set_result(True)

    def on_cancel(self, goal_handle):
        return CancelResponse.ACCEPT

    async def execute(self, goal_handle):
        numbers = []
        for number in range(goal_handle.request.order, -1, -1):
            self.tick = Future()
            await self.tick
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return Fibonacci.Result(sequence=numbers)
            numbers.append(number)
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        goal_handle.succeed()
        return Fibonacci.Result(sequence=numbers)


lab.spin(Countdown())
"""
_LOOK = """            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return Fibonacci.Result(sequence=numbers)
"""
_CANCEL = '        self.server.register_cancel_callback(self.on_cancel)\n'
_AWAIT = """            self.tick = Future()
            await self.tick
"""
_SLEEPS = """            time.sleep(0.05)
"""
_THREADS = changed(
    _COUNTDOWN,
    (
        'from rclpy.node import Node\nfrom rclpy.task import Future\n',
        'from rclpy.callback_groups import ReentrantCallbackGroup\nfrom rclpy.node import Node\n',
    ),
    ('from rclpy.action', 'import time\n\nfrom rclpy.action'),
    (
        "        self.server = ActionServer(self, Fibonacci, 'countdown', self.execute)\n",
        '        group = ReentrantCallbackGroup()\n'
        '        self.server = ActionServer(\n'
        "            self, Fibonacci, 'countdown', self.execute, callback_group=group\n"
        '        )\n',
    ),
    (
        '        self.tick = Future()\n'
        '        self.timer = self.create_timer(0.05, self.on_timer)\n\n'
        '    def on_timer(self):\n        self.tick.set_result(True)\n',
        '',
    ),
    ('    async def', '    def'),
    (_AWAIT, _SLEEPS),
)
_IN_THREAD = changed(
    _THREADS,
    ('import time\n', 'import threading\nimport time\n'),
    (
        'from rclpy.node import Node\n',
        'from rclpy.executors import MultiThreadedExecutor\nfrom rclpy.node import Node\n',
    ),
    (
        'lab.spin(Countdown())',
        'executor = MultiThreadedExecutor()\n'
        'executor.add_node(Countdown())\n'
        'threading.Thread(target=executor.spin, daemon=True).start()',
    ),
)


def _draw() -> list[Goal]:
    return [Goal({'order': random.randint(4, 6)}), Goal({'order': random.randint(1, 3)})]


def _draw_canceled() -> list[Goal]:
    # Two seconds and a half. A server that can't be stopped is not to go on for long, and a busy
    # machine has time to cancel.
    order = random.randint(46, 52)
    return [Goal({'order': order}, cancel_after=random.randint(3, 5)), Goal({'order': 2})]


def _wanted(pursuit: Pursuit) -> list[int]:
    return list(range(pursuit.goal.fields['order'], -1, -1))


def _counts(pursuits: Sequence[Pursuit]) -> None:
    before: list[int] = []
    for pursuit in pursuits:
        expect_ending(pursuit, 'succeeded')
        wanted = _wanted(pursuit)
        expect_numbers(pursuit, wanted, numbers(pursuit.result), before, 'result')
        came = [numbers(feedback) for feedback in pursuit.feedback]
        if came != [wanted[: i + 1] for i in range(len(wanted))]:
            raise Fail(
                f'{len(wanted)} feedbacks, each with the numbers so far',
                f'{len(came)} feedbacks: {expect.show(came)}',
                why='A client sees by them how far the goal is.',
                todo='After each number: goal_handle.publish_feedback(...)',
            )
        before = wanted


def _cancels(pursuits: Sequence[Pursuit]) -> None:
    first, second = pursuits
    if first.cancel_accepted is None:
        raise Fail(
            'a goal that takes so long that it can be canceled',
            f'it was {first.ending}, with {len(first.feedback)} feedbacks',
            why='All numbers were counted at once, or no feedback came on the way.',
            todo='Let some time pass before each number: await a Future that a timer completes.',
        )
    expect_ending(first, 'canceled')
    wanted, seen = _wanted(first), numbers(first.result)
    least = first.goal.cancel_after
    if seen != wanted[: len(seen)] or not least <= len(seen):
        raise Fail(
            f'the result has the numbers so far, at least {expect.show(wanted[:least])}',
            f'result = {expect.show(seen)}',
            why='Also a goal that was canceled has a result: what was done until then.',
            todo='return Fibonacci.Result(sequence=numbers) after goal_handle.canceled()',
        )
    expect_ending(second, 'succeeded')
    expect_numbers(second, _wanted(second), numbers(second.result), seen, 'result')


countdown = Exercise(
    name='countdown',
    task='Serve the action /countdown, whose goals can be canceled.',
    serves={NAME: ACTION},
    clauses=(
        Serves(NAME, ACTION),
        Pursues(
            NAME,
            'each goal succeeds; its result is the numbers from `order` down to 0, and there is a '
            'feedback after each number, with those so far',
            _draw,
            _counts,
        ),
        Pursues(
            NAME,
            'a goal that a client cancels is canceled, its result is the numbers so far, and the '
            'next goal succeeds',
            _draw_canceled,
            _cancels,
        ),
    ),
    hints=[
        'The server of this lesson awaits a tick before each number. So can yours.',
        'cancel_callback accepts the request. Who ends the goal? The loop, which has to look.',
        'if goal_handle.is_cancel_requested: goal_handle.canceled() and return the result so far',
    ],
    answer=Solution(
        _COUNTDOWN,
        'While execute awaits the tick, other callbacks run: also the one that accepts the '
        'request to cancel. After each tick the loop looks whether somebody wants an end.',
    ),
    styles=[
        Style(
            'lambda',
            changed(
                _COUNTDOWN,
                ('(self.on_cancel)', '(lambda handle: CancelResponse.ACCEPT)'),
                (
                    '    def on_cancel(self, goal_handle):\n'
                    '        return CancelResponse.ACCEPT\n\n',
                    '',
                ),
            ),
        ),
        Style('an executor of its own in a thread', _IN_THREAD),
        Style('own process', in_process(_COUNTDOWN), process=True),
        Style('own process, several threads', own_executor(in_process(_THREADS)), process=True),
    ],
    wrong=[
        Wrong(
            'another name',
            changed(_COUNTDOWN, ("Fibonacci, 'countdown'", "Fibonacci, 'count_down'")),
            "Write the name as '/countdown'",
        ),
        Wrong(
            'no cancel_callback',
            changed(_COUNTDOWN, (_CANCEL, '')),
            'The request to cancel was rejected',
        ),
        Wrong(
            'cancel_callback rejects',
            changed(_COUNTDOWN, ('CancelResponse.ACCEPT', 'CancelResponse.REJECT')),
            'The request to cancel was rejected',
        ),
        Wrong(
            'nobody looks',
            changed(_COUNTDOWN, (_LOOK, ''), ('await self.tick', 'await self.tick')),
            'To accept a request to cancel ends nothing.',
        ),
        Wrong(
            'ended without a word',
            changed(_COUNTDOWN, ('                goal_handle.canceled()\n', '')),
            'had not said how the goal ended',
        ),
        Wrong(
            'an empty result',
            changed(
                _COUNTDOWN,
                (
                    'canceled()\n                return Fibonacci.Result(sequence=numbers)',
                    'canceled()\n                return Fibonacci.Result()',
                ),
            ),
            'Also a goal that was canceled has a result',
        ),
        Wrong(
            'succeeds though canceled',
            changed(_COUNTDOWN, ('goal_handle.canceled()', 'goal_handle.succeed()')),
            'it was succeeded',
        ),
        Wrong(
            'time.sleep()',
            changed(
                _COUNTDOWN,
                (_AWAIT, _SLEEPS),
                ('    async def', '    def'),
                ('from rclpy.action', 'import time\n\nfrom rclpy.action'),
            ),
            'is still running',
        ),
        Wrong(
            'all at once',
            changed(_COUNTDOWN, (_AWAIT, '')),
            'All numbers were counted at once',
        ),
        Wrong(
            'stops at 1',
            changed(_COUNTDOWN, ('-1, -1)', '0, -1)')),
            'The numbers are others.',
        ),
        Wrong(
            'no feedback',
            changed(
                _COUNTDOWN,
                (
                    'goal_handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))\n',
                    'pass\n',
                ),
            ),
            'A client sees by them how far the goal is.',
        ),
        Wrong(
            'a typing error',
            changed(_COUNTDOWN, ('numbers.append(number)', 'numbers.append(nunber)')),
            'NameError',
            outcome=Outcome.ERROR,
            refused='The name is not defined.',
        ),
    ],
)
