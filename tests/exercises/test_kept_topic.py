"""A node that kept the topic of the exercise before is named, and so is a cell that was run."""

from __future__ import annotations

from typing import Any

import pytest

NODE = """
from rclpy.node import Node
from std_msgs.msg import Int16


class {name}(Node):
    def __init__(self):
        super().__init__('{name}')
        self.publisher = self.create_publisher(Int16, '{topic}', 10)
        self.timer = self.create_timer({period}, self.on_timer)
        self.number = 1

    def on_timer(self):
        self.publisher.publish(Int16(data=self.number))
        self.number += {step}


{spin}
"""


def node(name: str, topic: str, period: float, step: int, spin: str = 'lab.spin({}())') -> str:
    made = spin.format(name)
    return NODE.format(name=name, topic=topic, period=period, step=step, spin=made)


def check(kernel: Any, name: str) -> str:
    return ' '.join(kernel.run(f'lesson.{name}.check()').text.split())


@pytest.fixture
def lesson(kernel: Any) -> Any:
    kernel.run('import labkit as lab; lesson = lab.lesson("odds")')
    return kernel


@pytest.mark.slow('several kernels')
@pytest.mark.parametrize('ids', [('ones-starter', 'count-up-starter'), ('', ''), ('mine', 'new')])
def test_the_topic_of_the_exercise_before_is_named(lesson: Any, ids: tuple[str, str]) -> None:
    lesson.run(node('ones', 'ones', 0.1, 0), cell_id=ids[0])
    assert check(lesson, 'ones').startswith('PASS')
    # Nothing is written for the next one: the node of the first is where it belongs.
    assert check(lesson, 'count_up').startswith('NOT ATTEMPTED')
    assert check(lesson, 'stay_within').startswith('NOT ATTEMPTED')
    lesson.run(node('odd_source', 'ones', 0.2, 2), cell_id=ids[1])
    lesson.run('%ros2 topic list')
    told = check(lesson, 'count_up')
    assert told.startswith('FAIL: count_up')
    assert "/odd_source publishes on /ones, the topic of exercise 1. Next: Write '/odds'." in told


def test_a_cell_that_was_run_and_has_left_no_node_is_told(lesson: Any) -> None:
    lesson.run('class Ones:\n    # Write here.\n    ...', cell_id='ones-starter')
    assert check(lesson, 'ones').startswith('NOT ATTEMPTED')
    code = 'def main():\n    node = lab.spin(None)\n'
    lesson.run(code, cell_id='ones-starter')
    told = check(lesson, 'ones')
    assert told.startswith('FAIL: ones')
    assert 'the cell, which ran, and no node of it' in told
