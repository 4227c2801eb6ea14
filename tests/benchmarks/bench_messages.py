"""A message on its way: labkit's background thread against a plain script with rclpy.spin.

Both run the same node: a publisher, and a subscription whose callback publishes the next message;
beside it none, ten or forty nodes that have something to wait for. They take turns, so that what
else the machine does hits both alike; what counts is the ratio.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
from collections.abc import Iterator

from kernel import Kernel
from table import Row
from turns import Figures, take_turns

__all__ = ['tables']

NODE = """
import json, sys, threading, time
from rclpy.node import Node
from std_msgs.msg import String

# Other programs disturb most stretches of a busy machine, and slow down those they disturb. So
# the throughput is that of the best tenth of the stretches.
STRETCH = 50

class Echo(Node):
    def __init__(self, counts, finish):
        super().__init__('echo')
        # One message after the other for the delay; then ten on their way for the throughput.
        self.runs, self.finish, self.found = [(counts[0], 1), (counts[1], 10)], finish, {}
        self.publisher = self.create_publisher(String, 'echo', 100)
        self.create_subscription(String, 'echo', self.on_message, 100)
        self.timer = self.create_timer(0.05, self.begin)
        self.message = String(data='x' * 32)

    def begin(self):
        self.timer.cancel()
        self.left, in_flight = self.runs.pop(0)
        self.delays, self.sent, self.marks = [], [], []
        self.cpu = time.thread_time()
        self.marks.append(time.perf_counter())
        for _ in range(in_flight):
            self.send()

    def send(self):
        self.sent.append(time.perf_counter())
        self.publisher.publish(self.message)

    def on_message(self, message):
        now = time.perf_counter()
        self.delays.append(now - self.sent[len(self.delays)])
        self.left -= 1
        if self.left % STRETCH == 0:
            self.marks.append(now)
        if self.left > 0:
            self.send()
        elif self.left == 0:
            self.note(time.thread_time() - self.cpu)
            if self.runs:
                self.timer.reset()
            else:
                self.finish()

    def note(self, cpu):
        if self.runs:
            delays = sorted(self.delays)
            self.found['p50'] = 1e6 * delays[len(delays) // 2]
            self.found['p99'] = 1e6 * delays[int(0.99 * (len(delays) - 1))]
            self.found['cpu'] = 1e6 * cpu / len(delays)
        else:
            gaps = sorted(end - begin for begin, end in zip(self.marks, self.marks[1:]))
            self.found['rate'] = STRETCH / gaps[len(gaps) // 10]

    def result(self):
        return json.dumps(self.found)

def make_others(count):
    others = []
    for number in range(count):
        other = Node(f'other_{number}')
        other.create_subscription(String, f'other_{number}', lambda message: None, 10)
        other.create_timer(5.0, lambda: None)
        others.append(other)
    return others

def compute():
    # What a cell may do meanwhile: pure Python, never waiting.
    return sum(i * i for i in range(1000))
"""
PLAIN = """
import rclpy

class Finished(Exception):
    pass

def finish():
    raise Finished

from rclpy.executors import SingleThreadedExecutor

rclpy.init()
node = Echo({counts}, finish)
executor = SingleThreadedExecutor()
others = make_others({others})
for each in (node, *others):
    executor.add_node(each)
try:
    executor.spin()
except Finished:
    pass
print(node.result(), flush=True)
import os
os._exit(0)
"""
PLAIN_LOADED = """
import rclpy

done = threading.Event()
rclpy.init()
node = Echo({counts}, done.set)
thread = threading.Thread(target=rclpy.spin, args=(node,))
thread.start()
while not done.is_set():
    compute()
print(node.result())
rclpy.shutdown()
thread.join()
"""
LABKIT = """
import labkit as lab

done = threading.Event()
lab.start()
others = [lab.spin(each) for each in make_others({others})]
node = lab.spin(Echo({counts}, done.set))
{wait}
print(node.result())
for each in (node, *others):
    lab.remove(each)
"""
IDLE = 'done.wait()'
LOADED = 'while not done.is_set():\n    compute()'


# Ratios of a kernel to a script that the course has set itself: p50 by the number of other nodes.
QUIET = {'p99': {'at_most': 1.0}, 'rate': {'at_least': 2.5}, 'cpu': {'at_most': 0.45}}
BUSY = {'p50': {'at_most': 1.0}, 'rate': {'at_least': 1.0}}
MOST_TURNS = 5


def tables(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure, and give title and rows of each table."""
    with Kernel() as kernel:
        for others, most, counts in (
            (0, 0.4, (3000, 6000)),
            (10, 0.3, (1000, 2000)),
            (40, 0.3, (400, 800)),
        ):
            targets = {**QUIET, 'p50': {'at_most': most}}
            title = f'A message, {others + 1} nodes, the main thread waits'
            yield title, _rows(kernel, PLAIN, IDLE, counts, quick, targets, others)
        title = 'A message, the main thread computes'
        yield title, _rows(kernel, PLAIN_LOADED, LOADED, (300, 1500), quick, BUSY)


def _rows(
    kernel: Kernel,
    plain: str,
    wait: str,
    counts: tuple[int, int],
    quick: bool,
    targets: dict[str, dict[str, float]],
    others: int = 0,
) -> list[Row]:
    words = {'counts': (20, 100) if quick else counts, 'wait': wait, 'others': others}
    ways = {
        'plain': lambda: _script(plain.format(**words)),
        'kernel': lambda: json.loads(kernel.run(NODE + LABKIT.format(**words))),
    }
    seen = take_turns(ways, ('p50', 'rate', 'cpu'), 1 if quick else MOST_TURNS)

    def typical(name: str, key: str) -> float:
        return statistics.median(each[key] for each in seen[name])

    rows = []
    for key, what, unit in (
        ('p50', 'delay, half below', 'us'),
        ('p99', 'delay, 99 of 100 below', 'us'),
        ('rate', 'throughput', 'messages/s'),
        # Of the thread that spins: hardly disturbed by what else the machine does.
        ('cpu', 'CPU time a message', 'us'),
    ):
        rows.append(Row(f'{what}: rclpy.spin', typical('plain', key), unit))
        rows.append(Row(f'{what}: lab.spin in a kernel', typical('kernel', key), unit))
        ratio = typical('kernel', key) / typical('plain', key)
        rows.append(Row(f'{what}: kernel / rclpy.spin', ratio, '', **targets.get(key, {})))
    return rows


def _script(code: str) -> Figures:
    command = [sys.executable, '-c', NODE + code]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    result: Figures = json.loads(done.stdout)
    return result
