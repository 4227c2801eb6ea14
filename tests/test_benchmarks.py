"""The benchmarks run. What they measure is for people to judge."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).with_name('benchmarks')
ROWS = {
    'messages': [
        *('delay, half below: rclpy.spin', 'delay, half below: kernel / rclpy.spin'),
        *(
            'throughput: kernel / rclpy.spin',
            'delay, 99 of 100 below: lab.spin in a kernel',
        ),
    ],
    'process': [
        *('CPU, labkit started', 'memory, labkit started', 'import labkit', 'the whole process'),
    ],
    'ros2': ['topic list', 'node info', 'ros2 topic list'],
    'views': ['to the page: monitor', 'to the page: plot', 'an empty cell: monitor'],
    'soak': ['messages', 'memory at the end'],
    'lessons': ['00_start_here'],
    'course': ['JupyterLab answers'],
    'bags': ['throughput: to mcap / bare', 'lost: to sqlite3', 'memory, second half: to mcap'],
}


@pytest.mark.parametrize('name', ROWS)
def test_tables_have_figures(lab_env: dict[str, str], name: str) -> None:
    command = [sys.executable, str(BENCHMARKS), '--quick', name]
    done = subprocess.run(command, env=lab_env, capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stderr
    for row in ROWS[name]:
        lines = [line for line in done.stdout.splitlines() if line.startswith(row)]
        assert lines, row
        for line in lines:
            # Without an environment of the course there is no JupyterLab to start.
            assert re.search(r'  \d+\.\d\d  |no \.venv', line), line


def test_a_missed_target_is_told() -> None:
    code = (
        'from table import Row, show\n'
        'show("title", [Row("small", 1.0, "s", at_most=2), Row("big", 3.0, "s", at_most=2),\n'
        '               Row("slow", 0.5, at_least=0.95), Row("none", None, "why", at_most=2)])'
    )
    command = [sys.executable, '-c', code]
    done = subprocess.run(command, cwd=BENCHMARKS, capture_output=True, text=True, timeout=60)
    words = [line.split()[0] + ' ' + line.split()[-1] for line in done.stdout.splitlines() if line]
    assert words[1:] == ['small met', 'big MISSED', 'slow MISSED', 'none measured']
