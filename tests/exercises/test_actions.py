"""Clauses on actions: outcomes of goals, and verdicts on wrong servers."""

from __future__ import annotations

import pytest

SETUP = """
import time
import labkit as lab
from labkit.exercises import Exercise, Lesson, Solution, expect
from labkit.exercises.clauses import Goal, Pursues, Serves
from labkit.exercises.setup_cell import begin
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.task import Future
from test_msgs.action import Fibonacci

ACTION = 'test_msgs/action/Fibonacci'
seen = []

exercise = Exercise(
    name='count', task='Serve /count.', serves={'/count': ACTION},
    clauses=[
        Serves('/count', ACTION),
        Pursues('/count', 'goals', lambda: [
            Goal({'order': 3}), Goal({'order': 0}), Goal({'order': 30}, cancel_after=2),
        ], seen.extend),
    ],
    hints=['.'], answer=Solution('', '', ''))
begin(Lesson('odds', '04_odds.ipynb', exercises=[exercise]))
lab.start()


class Counter(Node):
    def __init__(self, name='/count'):
        super().__init__('counter')
        self.server = ActionServer(self, Fibonacci, name, self.execute)
        self.server.register_cancel_callback(lambda handle: CancelResponse.ACCEPT)
        self.server.register_goal_callback(lambda goal: GoalResponse(1 + bool(goal.order)))
        self.tick = Future()
        self.create_timer(0.02, lambda: self.tick.set_result(True))

    async def execute(self, handle):
        numbers = []
        while len(numbers) < handle.request.order:
            self.tick = Future()
            await self.tick
            if handle.is_cancel_requested:
                handle.canceled()
                return Fibonacci.Result(sequence=numbers)
            numbers.append(len(numbers))
            handle.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        handle.succeed()
        return Fibonacci.Result(sequence=numbers)

"""


@pytest.fixture
def cell(kernel):
    assert not kernel.run(SETUP).error

    def run(code: str) -> str:
        result = kernel.run(code)
        assert not result.error, result.traceback
        return result.text

    return run


def test_goals_are_sent_one_after_the_other(cell):
    cell('counter = lab.spin(Counter())')
    assert cell('exercise.check()').startswith('PASS')
    assert cell("""
print([pursuit.ending for pursuit in seen], [pursuit.cancel_accepted for pursuit in seen])
print([list(feedback.sequence) for feedback in seen[0].feedback], list(seen[0].result.sequence))
print(2 <= len(seen[2].result.sequence) < 30)
""") == (
        "['succeeded', 'rejected', 'canceled'] [None, None, True]\n"
        '[[0], [0, 1], [0, 1, 2]] [0, 1, 2]\nTrue\n'
    )


def test_another_name_and_another_type_are_told(cell):
    cell("counter = lab.spin(Counter('/counts'))")
    assert "Write the name as '/count'" in ' '.join(cell('exercise.check()').split())
    cell("""
from test_msgs.action import NestedMessage
counter = Node('counter')
ActionServer(counter, NestedMessage, '/count', print)
lab.spin(counter)
""")
    text = ' '.join(cell('exercise.check()').split())
    assert 'Import Fibonacci from test_msgs.action and pass it to ActionServer().' in text


def test_a_server_that_sleeps_is_told(cell):
    cell("""
class Sleeper(Counter):
    def __init__(self):
        super().__init__()
        self.server.register_execute_callback(self.sleep)

    def sleep(self, handle):
        time.sleep(3)
        return Fibonacci.Result()

counter = lab.spin(Sleeper())
""")
    assert 'the callback sleep of /counter is still running' in ' '.join(
        cell('exercise.check()').split()
    )
