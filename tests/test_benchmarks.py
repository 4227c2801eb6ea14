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
    'class': ['memory: talker', 'lost: with the robot', 'passed', 'processor time of a check'],
    'lessons': ['00_start_here'],
    'course': ['JupyterLab answers'],
    'bags': ['throughput: to mcap / bare', 'lost: to sqlite3', 'memory, second half: to mcap'],
    'sim': [
        *('headless with scan, playground', 'real time, CPU of the robot', '/odom stamps'),
        *('real time, CPU of robot and open arena', 'on topics, speed=100', 'lock-step'),
    ],
}


@pytest.mark.slow('each benchmark')
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
            assert re.search(r'  -?\d+\.\d\d  |no \.venv', line), line


@pytest.mark.parametrize(
    ('ratios', 'turns'),
    [
        ([2.0, 2.1, 9.0], 2),
        ([2.0, 2.5, 2.4], 3),
        ([2.0, 4.0, 2.0, 4.0, 2.0, 4.0], 5),
    ],
)
def test_turns_are_taken_until_their_ratio_has_settled(ratios: list[float], turns: int) -> None:
    code = f"""
from turns import take_turns

order, ratios = [], {ratios!r}

def slow():
    order.append('slow')
    # The machine is twice as busy each time, and that says nothing.
    return {{'rate': 2.0 ** order.count('slow')}}

def quick():
    order.append('quick')
    count = order.count('quick')
    return {{'rate': ratios[count - 1] * 2.0 ** count}}

seen = take_turns({{'slow': slow, 'quick': quick}}, ['rate'], 5)
print(len(seen['slow']), len(seen['quick']), *order[:4])
"""
    done = subprocess.run(
        [sys.executable, '-c', code], cwd=BENCHMARKS, capture_output=True, text=True, timeout=60
    )
    assert done.stdout == f'{turns} {turns} slow quick quick slow\n', done.stderr


def test_python_without_the_packages_says_what_to_do() -> None:
    command = [sys.executable, '-S', str(BENCHMARKS)]
    told = subprocess.run([*command, '--help'], capture_output=True, text=True, timeout=60)
    assert told.returncode == 0, told.stderr
    assert all(f'  {name:<10}' in told.stdout for name in ROWS)
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert done.stderr.endswith('`python3 -m labkit test --fast` makes it)\n')


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
