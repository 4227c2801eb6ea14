"""What labkit costs when nothing happens, and how long it takes to start."""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator

from kernel import Kernel
from table import Row

__all__ = ['tables']

START = """
import json, time
begin = time.perf_counter()
import labkit as lab
imported = time.perf_counter()
lab.start()
started = time.perf_counter()
from rclpy.node import Node
from std_msgs.msg import String
loaded = time.perf_counter()
node = lab.spin(Node('first'))
heard = []
node.create_subscription(String, 'first', heard.append, 10)
publisher = node.create_publisher(String, 'first', 10)
publisher.publish(String(data='x'))
lab.wait_until(lambda: heard)
first = time.perf_counter()
lab.stop()
print(json.dumps({
    'import labkit': imported - begin,
    'lab.start(), rclpy loaded with it': started - imported,
    'first node and message': first - loaded,
    'lab.stop()': time.perf_counter() - first,
}))
"""
TALKER_AND_LISTENER = """
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.5, lambda: self.publisher.publish(String(data='Hello')))

listener = lab.spin(Node('listener'))
listener.create_subscription(String, 'chatter', lambda message: None, 10)
lab.spin(Talker())
"""
FORTY_NODES = """
for number in range(40):
    node = lab.spin(Node(f'node_{number}'))
    node.create_publisher(String, f'topic_{number}', 10)
    node.create_subscription(String, f'topic_{(number + 1) % 40}', lambda message: None, 10)
"""
# Seconds of processor time of a look, and how often one is taken.
LOOKS = """
import time
from labkit.silent import watch as module
begin = time.thread_time()
for _ in range({rounds}):
    module.watch.look()
print((time.thread_time() - begin) / {rounds} / module.EVERY_SEC)
"""


def tables(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure, and give title and rows of each table."""
    yield 'A kernel at rest', _at_rest(0.5 if quick else 10)
    yield 'Starting', _starting(1 if quick else 5)


def _at_rest(seconds: float) -> list[Row]:
    rows = []
    with Kernel() as kernel:

        def measure(what: str, most_cpu: float | None, most_memory: float | None) -> None:
            cpu = kernel.cpu_share(seconds)
            rows.append(Row(f'CPU, {what}', cpu, '% of a core', at_most=most_cpu))
            rows.append(Row(f'memory, {what}', kernel.memory(), 'MB', at_most=most_memory))

        measure('a kernel without labkit', None, None)
        kernel.run('import labkit as lab\nlab.start()')
        measure('labkit started', 1, 150)
        kernel.run(TALKER_AND_LISTENER)
        measure('talker and listener at 2 Hz', None, None)
        kernel.run(FORTY_NODES)
        share = 100 * float(kernel.run(LOOKS.format(rounds=5 if seconds < 1 else 100)))
        rows.append(Row('CPU, the watch with 40 nodes', share, '% of a core', at_most=1))
    return rows


def _starting(rounds: int) -> list[Row]:
    seen: dict[str, list[float]] = {}
    for _ in range(rounds):
        begin = time.perf_counter()
        command = [sys.executable, '-c', START]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        whole = time.perf_counter() - begin
        for what, seconds in {**json.loads(done.stdout), 'the whole process': whole}.items():
            seen.setdefault(what, []).append(1e3 * seconds)
    return [Row(what, statistics.median(times), 'ms') for what, times in seen.items()]
