"""A long day in small: messages and nodes without end, and what is left over of them.

python tests/benchmarks soak            # some 5 minutes; not among those that run by themselves
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator

from table import Row

__all__ = ['tables']

# Five nodes send a message round and round; meanwhile others come, hear one message, and go.
DAY = """
import json, os, sys, time
import psutil
import labkit as lab
from labkit.background.runtime import runtime
from rclpy.node import Node
from std_msgs.msg import String

MESSAGES, NODES = json.loads(sys.argv[1])

class Ring(Node):
    heard = 0

    def __init__(self, number):
        super().__init__(f'ring_{number}')
        self.out = self.create_publisher(String, f'ring_{(number + 1) % 5}', 10)
        self.create_subscription(String, f'ring_{number}', self.on_message, 10)

    def on_message(self, msg):
        Ring.heard += 1
        if Ring.heard < MESSAGES:
            self.out.publish(msg)

class Guest(Node):
    def __init__(self, number):
        super().__init__(f'guest_{number % 7}')
        self.ticks = 0
        self.create_subscription(String, 'ring_0', self.on_message, 10)
        self.create_timer(0.001, self.on_timer)

    def on_message(self, msg):
        pass

    def on_timer(self):
        self.ticks += 1

process, begin = psutil.Process(), time.monotonic()
memory = []

def note():
    memory.append(process.memory_info().rss / 1e6)

rings = [lab.spin(Ring(number)) for number in range(5)]
rings[4].out.publish(String(data='x' * 32))
for number in range(NODES):
    if number % max(NODES // 10, 1) == 0:
        note()
    guest = lab.spin(Guest(number))
    lab.wait_until(lambda: guest.ticks, timeout_sec=60)
    lab.remove(guest)
note()
while Ring.heard < MESSAGES:
    time.sleep(0.1)
note()
print(json.dumps({
    'heard': Ring.heard, 'nodes': len(runtime.nodes()), 'memory': memory,
    'threads': process.num_threads(), 'files': process.num_fds(),
    'seconds': time.monotonic() - begin,
}))
"""


def tables(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure, and give title and rows of the table."""
    messages, nodes = (2000, 20) if quick else (1_000_000, 10_000)
    command = [sys.executable, '-c', DAY, json.dumps([messages, nodes])]
    done = subprocess.run(command, capture_output=True, text=True, timeout=3600)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    day = json.loads(done.stdout)
    memory = day['memory']
    # The first tenth fills what is kept for good: classes, caches, pools.
    grown = memory[-1] - memory[2]
    yield (
        'A long day in small',
        [
            Row('messages', day['heard'], '', at_least=messages),
            Row('nodes made and removed', nodes, ''),
            Row('nodes left, of 5', day['nodes'], '', at_most=5),
            Row('memory at the start', memory[0], 'MB'),
            Row('memory at the end', memory[-1], 'MB'),
            Row('memory, from a tenth of the nodes to the end', grown, 'MB', at_most=5),
            Row('threads at the end', day['threads'], ''),
            Row('open files at the end', day['files'], ''),
            Row('time', day['seconds'], 's'),
        ],
    )
