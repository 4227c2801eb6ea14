"""The list of tests that decide nothing: short, complete, and of tests that there are."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from tests.gate import QUARANTINE, quarantine

ROOT = QUARANTINE.parent.parent
MOST = 15


def test_list_is_short_and_each_line_complete() -> None:
    tests = [one.test for one in quarantine()]
    assert len(tests) <= MOST
    assert len(set(tests)) == len(tests)


def test_what_a_lesson_stands_on_is_never_in_it() -> None:
    for one in quarantine():
        assert one.test.startswith('tests/'), 'a cell of a lesson'
        assert not one.test.endswith(('-solution]', '-untouched]')), 'what every learner meets'


def test_its_tests_exist() -> None:
    tests = [one.test for one in quarantine()]
    command = [sys.executable, '-m', 'pytest', '--collect-only', '-q', '-p', 'no:cacheprovider']
    if tests:
        done = subprocess.run([*command, *tests], cwd=ROOT, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(
    'line',
    [
        'tests/test_files.py::test_a',
        'tests/test_files.py::test_a | yesterday | it fails | the clock',
        'tests/test_files.py::test_a | 2026-11-27 | it fails |',
    ],
)
def test_line_of_another_form_is_refused(line: str) -> None:
    with pytest.raises(ValueError, match=re.escape('test | YYYY-MM-DD')):
        quarantine(line)
