"""What the machine has done is an ERROR with its true reason, and no fault of the learner's."""

from __future__ import annotations

import errno
import os
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from by_hand import ByHand

from labkit.errors import LabError
from labkit.exercises import Exercise, Outcome, Probe, Solution
from labkit.exercises.machine_faults import refuse_machine_fault

PREFIX = Path(sys.prefix) / 'lib/python3/site-packages'


def said(path: str, last: str) -> list[str]:
    return ['Traceback (most recent call last):', f'  File "{path}", line 3, in <module>', last]


@pytest.mark.parametrize(
    ('output', 'code', 'reason'),
    [
        (said('/home/me/talker.py', "ModuleNotFoundError: No module named 'rclpy'"), 1, 'rclpy'),
        (said(f'{PREFIX}/x.py', "ModuleNotFoundError: No module named 'lark'"), 1, 'lark'),
        (said('/x.py', 'OSError: [Errno 28] No space left on device'), 1, 'no space left'),
        (said('/x.py', 'MemoryError'), 1, 'enough memory'),
        ([], -9, 'killed from outside'),
        (['Hello'], 137, 'killed from outside'),
    ],
)
def test_the_reason_is_read_off_what_a_program_says(
    output: list[str], code: int, reason: str
) -> None:
    with pytest.raises(LabError, match=reason):
        refuse_machine_fault(output, code)


@pytest.mark.parametrize(
    ('output', 'code'),
    [
        (said('/home/me/talker.py', "ModuleNotFoundError: No module named 'my_pakage'"), 1),
        (said('/home/me/talker.py', "NameError: name 'rclpy' is not defined"), 1),
        ([], 0),
        ([], None),
        (['KeyboardInterrupt'], -2),
    ],
)
def test_what_the_learner_has_done_is_none(output: list[str], code: int | None) -> None:
    refuse_machine_fault(output, code)


@pytest.mark.parametrize(
    ('error', 'reason'),
    [
        (OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)), 'no space left'),
        (MemoryError(), 'enough memory'),
        (ModuleNotFoundError("No module named 'mcap'", name='mcap'), 'The package mcap'),
    ],
)
def test_a_check_that_the_machine_has_ended_says_why(
    lab: ModuleType, error: Exception, reason: str
) -> None:
    def judge(probe: Probe) -> None:
        raise error

    solution = Solution('', '', '')
    asked = Exercise(name='ones', task='', stage=ByHand(judge), hints=[''], answer=solution)
    verdict = asked.check()
    assert verdict.outcome is Outcome.ERROR
    assert reason in verdict.why
    assert 'fault of the course' not in repr(verdict)


def test_a_program_that_was_killed_is_no_fault_of_the_learners(kernel: Any) -> None:
    kernel.run('import labkit as lab, subprocess, sys; lesson = lab.lesson("odds")')
    kernel.run('program = "import time; time.sleep(1000)  # publishes on /ones"')
    kernel.run("mine = subprocess.Popen([sys.executable, '-c', program])")
    kernel.run('mine.kill(); mine.wait()')
    told = ' '.join(kernel.run('lesson.ones.check()').text.split())
    assert told.startswith('ERROR: ones')
    assert 'killed from outside (SIGKILL)' in told
