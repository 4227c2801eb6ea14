"""A check of an asyncio task, which stands still while the cell of the check runs."""

from __future__ import annotations

from typing import Any

import pytest

from labkit.exercises.found_lessons import load

SETUP = """
import asyncio
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import Int16
lesson = lab.lesson('odds')
node = lab.spin(Node('ones'))
publisher = node.create_publisher(Int16, 'ones', 10)
"""
TASK = """
async def work(value):
    while True:
        publisher.publish(Int16(data=value))
        await asyncio.sleep(0.1)

task = asyncio.create_task(work({value}))
"""


@pytest.mark.slow('several checks in a kernel of its own')
def test_a_task_of_the_notebook_is_judged_once_the_cell_has_ended(kernel: Any) -> None:
    kernel.run(SETUP)
    kernel.run(TASK.format(value=1))
    assert kernel.run('lesson.ones.check()').text.startswith('CHECKING: ones')
    assert 'PASS: ones' in kernel.run('await _').text
    kernel.run('task.cancel()')
    kernel.run(TASK.format(value=2))
    kernel.run('lesson.ones.check()')
    assert 'Another number is put into the message.' in kernel.run('await _').text


@pytest.mark.slow('a check that is held up')
def test_a_check_that_goes_on_is_neither_true_nor_false(kernel: Any) -> None:
    kernel.run(SETUP)
    kernel.run(TASK.format(value=2))
    assert (
        'LabError: The check of ones has no verdict yet'
        in kernel.run('checked = lesson.ones.check()\nassert checked').error
    )
    told = kernel.run('verdict = await checked\nassert verdict, verdict')
    assert told.error.startswith('AssertionError: FAIL: ones')
    assert 'FAIL: ones' in kernel.run('print(checked)').text
    assert kernel.run('print(bool(checked), bool(verdict))').text == 'False False\n'


def test_a_check_without_a_task_answers_at_once(kernel: Any) -> None:
    kernel.run(SETUP)
    assert 'FAIL: ones' in kernel.run('lesson.ones.check()').text


@pytest.mark.slow('a check that is held up')
def test_the_answer_takes_the_place_of_the_waiting(kernel: Any) -> None:
    kernel.run(SETUP)
    kernel.run(TASK.format(value=1))
    kernel.run('checked = lesson.ones.check()\nchecked')
    assert 'PASS: ones' in kernel.run('await checked').text
    assert kernel.run('print(checked._handle.words, checked._handle.done)').text == 'PASS. True\n'


@pytest.mark.slow('checks in real time')
def test_checks_in_a_row_judge_one_after_the_other(kernel: Any) -> None:
    kernel.run(SETUP)
    kernel.run(TASK.format(value=1))
    kernel.run(load('odds').count_up.answer.code)
    before = kernel.run('import sys; sys.getswitchinterval()').text
    names = ['ones', 'count_up', 'ones', 'count_up']
    kernel.run('checked = []')
    for name in names:
        kernel.run(f'checked.append(lesson.{name}.check())\nchecked[-1]')
    kernel.run('verdicts = [await each for each in checked]')
    told = kernel.run('[repr(each).splitlines()[0] for each in verdicts]').text
    assert told.strip() == str([f'PASS: {name}' for name in names])
    assert kernel.run('sys.getswitchinterval()').text == before


def test_a_check_without_a_task_waits_for_those_that_go_on(kernel: Any) -> None:
    kernel.run(SETUP)
    kernel.run(TASK.format(value=1))
    kernel.run('checked = lesson.ones.check()\nchecked')
    kernel.run(load('odds').count_up.answer.code)
    kernel.run('task.cancel()\nawait asyncio.sleep(0)')
    assert 'PASS: count_up' in kernel.run('lesson.count_up.check()').text
    assert kernel.run('checked._thread.is_alive()').text.strip() == 'False'
