"""What a node publishes with the publisher of another one is told, with where it went."""

from __future__ import annotations

from types import ModuleType
from typing import Any

from rclpy.node import Node
from std_msgs.msg import Int16, String

from labkit.exercises import Exercise, Outcome, Solution
from labkit.exercises.clauses import Publishes

INT16 = 'std_msgs/msg/Int16'


def asked() -> Exercise:
    return Exercise(
        name='ones',
        task='A task.',
        clauses=[Publishes('/ones', 10.0, INT16)],
        hints=[''],
        answer=Solution('', '', ''),
    )


def test_a_publisher_without_self_is_told_with_its_topic(lab: ModuleType) -> None:
    publisher: Any = lab.spin(Node('editor')).create_publisher(String, 'news', 10)

    class Ones(Node):
        def __init__(self) -> None:
            super().__init__('ones')
            self.publisher = self.create_publisher(Int16, 'ones', 10)
            self.timer = self.create_timer(0.1, self.on_timer)

        def on_timer(self) -> None:
            publisher.publish(String(data='1'))

    lab.spin(Ones())
    verdict = asked().check()
    assert verdict.outcome is Outcome.FAIL
    assert 'on_timer of /ones publishes on /news, with the publisher of /editor' in verdict.why
    assert verdict.todo.startswith('Write self.')
