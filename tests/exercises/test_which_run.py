"""A verdict says which run of a cell it has judged: what failed last is told first."""

from __future__ import annotations

from typing import Any

import pytest

EARS = """
from rclpy.node import Node
from std_msgs.msg import String


class Ears(Node):
    def __init__(self):
        super().__init__('ears')
        self.subscription = self.create_subscription(String, '/chatter', self.on_text, 10)

    def on_text(self, msg):
        {line}


{spin}
"""
LOGS = "self.get_logger().info(f'I heard {msg.data}')"
STARTER = 'hear-chatter-starter'


def ears(line: str = LOGS, spin: str = 'lab.spin(Ears())') -> str:
    return EARS.format(line=line, spin=spin)


def check(kernel: Any) -> str:
    return ' '.join(kernel.run('lesson.hear_chatter.check()', cell_id='check').text.split())


@pytest.fixture
def lesson(kernel: Any) -> Any:
    kernel.run('import labkit as lab; lesson = lab.lesson("talker_listener")')
    return kernel


@pytest.mark.slow('several kernels')
def test_a_cell_that_failed_last_is_told_before_what_its_older_node_does(lesson: Any) -> None:
    lesson.run(ears(), cell_id=STARTER)
    assert check(lesson).startswith('PASS: hear_chatter')
    # Whether it gets as far as the node or not.
    for code in (ears(spin='lab.spin(Eras())'), f'colour\n{ears()}'):
        assert lesson.run(code, cell_id=STARTER).error
        told = check(lesson)
        assert told.startswith('ERROR: hear_chatter The cell that ran last raised NameError.')
        assert '/ears of run 2, still runs, and does what the task asks for.' in told
    # Another cell in between does not repair it.
    lesson.run('1 + 1', cell_id='other')
    assert check(lesson).startswith('ERROR: hear_chatter The cell of this exercise raised')
    lesson.run(ears(), cell_id=STARTER)
    assert check(lesson).startswith('PASS: hear_chatter')


@pytest.mark.slow('several kernels')
def test_an_error_of_an_older_node_comes_after_that_of_the_cell(lesson: Any) -> None:
    lesson.run(ears('self.get_logger().info(msg.text)'), cell_id=STARTER)
    assert 'The callback on_text of /ears raised AttributeError' in check(lesson)
    lesson.run(ears(spin='lab.spin(Eras())'), cell_id=STARTER)
    told = check(lesson)
    assert told.startswith('ERROR: hear_chatter The cell that ran last raised NameError.')
    older = 'An older node, /ears of run 2, still runs. Of it the check says: The callback on_text'
    assert older in told


def test_a_cell_that_has_nothing_to_do_with_it_fails_no_right_answer(lesson: Any) -> None:
    lesson.run(ears(), cell_id=STARTER)
    assert lesson.run('lesson.hear_chatter.chek()', cell_id='other').error
    assert check(lesson).startswith('PASS: hear_chatter')


def test_an_answer_in_a_new_cell_is_not_held_to_the_one_that_failed_before(lesson: Any) -> None:
    assert lesson.run(ears(spin='lab.spin(Eras())'), cell_id=STARTER).error
    lesson.run(ears(), cell_id='own')
    assert check(lesson).startswith('PASS: hear_chatter')


@pytest.mark.slow('several kernels')
def test_a_class_that_was_changed_and_not_spun_again_is_told(lesson: Any) -> None:
    lesson.run(ears('pass'), cell_id=STARTER)
    assert 'The callback does not log it' in check(lesson)
    lesson.run(ears(spin=''), cell_id=STARTER)
    told = check(lesson)
    assert told.startswith('FAIL: hear_chatter')
    assert 'The class Ears was changed after /ears was made, by run 2' in told
    assert 'lab.spin(Ears(...))' in told
    # The same text once more is no change.
    lesson.run(ears(), cell_id=STARTER)
    lesson.run(ears(spin=''), cell_id='own')
    told = check(lesson)
    assert told.startswith('PASS: hear_chatter')
    assert 'was changed' not in told
    lesson.run(ears('pass', spin=''), cell_id='own')
    told = check(lesson)
    assert told.startswith('PASS: hear_chatter')
    assert 'Judged was /ears of run 6. The class Ears was changed since' in told
