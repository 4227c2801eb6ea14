"""How soon `%ros2` answers in a notebook, and `ros2` in a terminal; how soon ten nodes speak."""

from __future__ import annotations

import json
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from kernel import Kernel
from table import Row
from turns import Figures, take_turns

__all__ = ['tables']

NODES = """
import labkit as lab
from rclpy.node import Node
from std_msgs.msg import String

for number in range({count}):
    node = lab.spin(Node(f'node_{{number}}', start_parameter_services=False))
    node.create_publisher(String, f'topic_{{number}}', 10)
"""
# What the learner waits for, without the way through JupyterLab.
MEASURE = """
import contextlib, io, json, time

shell = get_ipython()

def measure(line, rounds):
    times = []
    for _ in range(rounds):
        with contextlib.redirect_stdout(io.StringIO()):
            begin = time.perf_counter()
            shell.run_line_magic('ros2', line)
            times.append(1e3 * (time.perf_counter() - begin))
    return times

result = {{}}
for line in {lines!r}:
    first, *others = measure(line, {rounds})
    result[line] = [first, others]
print(json.dumps(result))
"""
TALKERS = [f'talker_{number}' for number in range(10)]
LINES = ['topic list', 'topic list -t', 'node list', 'node info /node_0', 'topic info /topic_0 -v']


def tables(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure, and give title and rows of each table."""
    for count in (3, 40):
        yield f'%ros2 in a notebook with {count} nodes', _in_kernel(count, 20 if quick else 200)
    yield 'ros2 in a terminal, alone', _in_terminal(1 if quick else 3)
    yield 'ten talkers, until each has spoken', _ten_talkers(2 if quick else 6)


def _in_kernel(count: int, rounds: int) -> list[Row]:
    rows = []
    with Kernel() as kernel:
        kernel.run(NODES.format(count=count))
        result = json.loads(kernel.run(MEASURE.format(lines=LINES, rounds=rounds)))
        for line, (first, others) in result.items():
            if line == LINES[0]:
                rows += [Row(f'{line}, the first time', first, 'ms')]
            limit = 5 if line == LINES[0] else None
            rows += [Row(line, statistics.median(others), 'ms', at_most=limit)]
            rows += [Row(f'{line}, 99 of 100 below', _late(others), 'ms')]
    return rows


def _late(times: list[float]) -> float:
    return statistics.quantiles(times, n=100)[98]


def _in_terminal(rounds: int) -> list[Row]:
    # Not that of a notebook that happens to run.
    env = {**os.environ, 'ROS_DOMAIN_ID': '0'}
    rows = []
    for words in (['topic', 'list'], ['interface', 'show', 'std_msgs/msg/String']):
        times = []
        for _ in range(rounds):
            begin = time.perf_counter()
            command = [sys.executable, '-m', 'labkit.ros2', *words]
            subprocess.run(command, env=env, check=True, capture_output=True)
            times.append(1e3 * (time.perf_counter() - begin))
        rows.append(Row(f'ros2 {" ".join(words)}', statistics.median(times), 'ms'))
    return rows


def _ten_talkers(most: int) -> list[Row]:
    nodes = [f'<node pkg="demo_nodes_py" exec="talker" name="{name}"/>' for name in TALKERS]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, 'ten.launch.xml')
        file.write_text(f'<launch>{"".join(nodes)}</launch>', encoding='utf-8')
        runs = [
            ['run', 'demo_nodes_py', 'talker', '--ros-args', '-r', f'__node:={name}']
            for name in TALKERS
        ]
        ways = {
            'ten times ros2 run': lambda: _until_all_speak(runs),
            'ros2 launch': lambda: _until_all_speak([['launch', str(file)]]),
        }
        seen = take_turns(ways, ['s'], most)
    run, launch = ([turn['s'] for turn in turns] for turns in seen.values())
    ratio = statistics.median(one / other for one, other in zip(launch, run, strict=True))
    return [
        Row('ten times ros2 run, side by side', statistics.median(run), 's'),
        Row('ros2 launch', statistics.median(launch), 's'),
        Row('ratio of the two', ratio, at_most=2),
    ]


def _until_all_speak(commands: Sequence[Sequence[str]]) -> Figures:
    """Start commands of `ros2` at once; tell when all talkers have said something, and end them.

    What they say goes into one file.
    """
    env = {**os.environ, 'ROS_DOMAIN_ID': '0'}
    with tempfile.NamedTemporaryFile() as said:
        begin = time.perf_counter()
        started = [
            subprocess.Popen(
                [sys.executable, '-m', 'labkit.ros2', *words],
                env=env,
                stdout=said,
                stderr=subprocess.STDOUT,
            )
            for words in commands
        ]
        while any(f'[{name}]' not in Path(said.name).read_text() for name in TALKERS):
            time.sleep(0.01)
        seconds = time.perf_counter() - begin
        for process in started:
            process.send_signal(signal.SIGINT)
        for process in started:
            process.wait()
    return {'s': seconds}
