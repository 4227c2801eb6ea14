"""What a class costs on one server: kernels with talker and listener, the robot, checks at once.

    python tests/benchmarks class                       # 1, 10, 30, 100 and 200 kernels
    python tests/benchmarks/bench_class.py 1 10 30      # other numbers, in rising order

Four kernels start at a time; the time to start is the work that it is. Each has what a learner's
has: a domain of its own, and nodes that hear each other.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import psutil
from jupyter_client.kernelspec import KernelSpecManager
from jupyter_client.manager import KernelManager
from table import Row

__all__ = ['tables']

SIZES = (1, 10, 30, 100, 200)
CHECKS = 30
AT_A_TIME = 4
TIMEOUT_SEC = 600
START = """
import labkit as lab
lab.start()
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(0.5, self.say)
        self.count = 0

    def say(self):
        self.publisher.publish(String(data=str(self.count)))
        self.count += 1

class Listener(Node):
    def __init__(self):
        super().__init__('listener')
        self.create_subscription(String, 'chatter', self.hear, 10)
        self.heard = []

    def hear(self, msg):
        self.heard.append(int(msg.data))

listener = lab.spin(Listener())
talker = lab.spin(Talker())
lab.wait_until(lambda: listener.heard, timeout_sec=600)
"""
# A gap in the numbers is a lost message.
LOST = """
import json
heard = listener.heard
print(json.dumps([heard[-1] - heard[0] + 1 - len(heard), len(heard)]))
"""
LIST = """
import time
begin = time.perf_counter()
get_ipython().run_line_magic('ros2', 'topic list')
print(time.perf_counter() - begin)
"""
ROBOT = """
robot = lab.spin(lab.Turtlebot())
from nav_msgs.msg import Odometry
from geometry_msgs.msg import Twist
seen = []
watcher = Node('watcher')
watcher.create_subscription(Odometry, 'odom', lambda msg: seen.append(1), 10)
wheels = watcher.create_publisher(Twist, 'cmd_vel', 10)
turn = Twist()
turn.angular.z = 0.5
watcher.create_timer(0.1, lambda: wheels.publish(turn))
lab.spin(watcher)
lab.wait_until(lambda: seen, timeout_sec=600)
"""
NO_ROBOT = 'lab.remove(robot)\nlab.remove(watcher)'
SOLUTION = 'lab.stop()\nlesson = lab.lesson("odds")\nexec(lesson.count_up.answer.code)'
CHECK = """
import time
begin = time.perf_counter()
verdict = lesson.count_up.check()
print(json.dumps([time.perf_counter() - begin, 'PASS' in str(verdict)]))
"""


class Learner:
    """A kernel, as a server of a class has one."""

    def __init__(self, folder: str) -> None:
        self._manager = KernelManager(
            kernel_name='python3',
            kernel_spec_manager=KernelSpecManager(kernel_dirs=[]),
            transport='ipc',
            ip=os.path.join(folder, 'socket'),
        )
        env = {**os.environ, 'LABKIT_HOME': folder, 'IPYTHONDIR': folder, 'JPY_SESSION_NAME': ''}
        env['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
        self._manager.start_kernel(cwd=folder, env=env, stderr=subprocess.DEVNULL)
        self._client = self._manager.client()
        self._client.start_channels()
        self._client.wait_for_ready(timeout=TIMEOUT_SEC)
        self.process = psutil.Process(self._manager.provisioner.process.pid)

    def run(self, code: str) -> str:
        """Run a cell; return what it prints last."""
        texts: list[str] = []

        def collect(message: dict) -> None:
            if message['msg_type'] == 'stream':
                texts.append(message['content']['text'])

        reply = self._client.execute_interactive(
            code, output_hook=collect, timeout=TIMEOUT_SEC, allow_stdin=False
        )
        if reply['content']['status'] != 'ok':
            raise RuntimeError('\n'.join(reply['content']['traceback']))
        return ''.join(texts).strip().rpartition('\n')[2]

    def close(self) -> None:
        """End it."""
        self._client.stop_channels()
        self._manager.shutdown_kernel(now=True)


class Class:
    """So many learners; their number only grows."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.learners: list[Learner] = []

    def grow(self, size: int) -> float:
        """Start kernels until there are so many; return the processor time of one start, s."""
        before = self._processor_time()
        new = range(len(self.learners), size)

        def start(number: int) -> Learner:
            folder = Path(self._folder.name, str(number))
            folder.mkdir()
            learner = Learner(str(folder))
            learner.run(START)
            return learner

        with ThreadPoolExecutor(AT_A_TIME) as pool:
            self.learners += pool.map(start, new)
        return (self._processor_time() - before) / len(new)

    def everybody(self, code: str, count: int | None = None) -> list[str]:
        """Let everybody, or so many, run a cell at the same time."""
        chosen = self.learners[:count]
        together = threading.Barrier(len(chosen))

        def one(learner: Learner) -> str:
            together.wait()
            return learner.run(code)

        with ThreadPoolExecutor(len(chosen)) as pool:
            return list(pool.map(one, chosen))

    def share_of_a_core(self, seconds: float) -> float:
        """Return what all of them use together, in per cent of one core."""
        before, begin = self._processor_time(), time.monotonic()
        time.sleep(seconds)
        return 100 * (self._processor_time() - before) / (time.monotonic() - begin)

    def _processor_time(self) -> float:
        return sum(sum(one.process.cpu_times()[:2]) for one in self.learners)

    def memory(self) -> float:
        """Return what all of them take, each its part of what is shared, in MB."""
        return sum(one.process.memory_full_info().pss for one in self.learners) / 1e6

    def close(self) -> None:
        """End all of them."""
        for learner in self.learners:
            learner.close()
        self._folder.cleanup()


def tables(quick: bool) -> Iterator[tuple[str, list[Row]]]:
    """Measure, and give title and rows of each table."""
    yield from of_sizes((1, 2) if quick else SIZES, 0.5 if quick else 10)


def of_sizes(sizes: Sequence[int], seconds: float) -> Iterator[tuple[str, list[Row]]]:
    """Measure classes of so many, in rising order, each for so long."""
    school = Class()
    try:
        for size in sizes:
            rows = [
                Row('start: processor time of a kernel with its nodes', school.grow(size), 's')
            ]
            rows += _at_rest(school, seconds)
            rows += _with_robot(school, seconds)
            yield f'{size} kernels, load {os.getloadavg()[0]:.1f}', rows
            if size >= CHECKS or size == sizes[-1]:
                yield f'Checks at once, {size} kernels', _checks(school)
    finally:
        school.close()


def _at_rest(school: Class, seconds: float) -> list[Row]:
    share = school.share_of_a_core(seconds)
    return [
        Row('memory: talker and listener', school.memory(), 'MB'),
        Row('processors: talker and listener', share, '% of a core'),
        Row('%ros2 topic list', 1e3 * float(school.learners[-1].run(LIST)), 'ms'),
        Row('lost: talker and listener', _lost(school), 'messages'),
    ]


def _with_robot(school: Class, seconds: float) -> list[Row]:
    school.everybody(ROBOT)
    share, memory = school.share_of_a_core(seconds), school.memory()
    rows = [
        Row('memory: and the robot, driven', memory, 'MB'),
        Row('processors: and the robot, driven', share, '% of a core'),
        Row('%ros2 topic list, with the robot', 1e3 * float(school.learners[-1].run(LIST)), 'ms'),
        Row('lost: with the robot', _lost(school), 'messages'),
    ]
    school.everybody(NO_ROBOT)
    return rows


def _lost(school: Class) -> int:
    return sum(json.loads(one)[0] for one in school.everybody(LOST))


def _checks(school: Class) -> list[Row]:
    """Let thirty press the button at once; the others go on. They start again afterwards."""
    count = min(CHECKS, len(school.learners))
    school.everybody(SOLUTION, count)
    chosen = [one.process for one in school.learners[:count]]
    before = sum(sum(one.cpu_times()[:2]) for one in chosen)
    verdicts = [json.loads(one) for one in school.everybody(CHECK, count)]
    used = sum(sum(one.cpu_times()[:2]) for one in chosen) - before
    school.everybody('lab.stop()\n' + START, count)
    return [
        Row('checks', count, 'at once'),
        Row('passed', sum(passed for _, passed in verdicts), 'of them'),
        Row('until the last verdict', max(seconds for seconds, _ in verdicts), 's'),
        Row('processor time of a check', used / count, 's'),
    ]


if __name__ == '__main__':
    from table import show

    for title, rows in of_sizes([int(word) for word in sys.argv[1:]] or SIZES, 10):
        show(title, rows)
