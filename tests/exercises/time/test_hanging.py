"""A callback that does not return is named; one that gets no turn is waited for."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

import pytest
from rclpy.node import Node
from std_msgs.msg import Int16

from labkit.background.runtime import runtime
from labkit.exercises import Fail, Probe
from labkit.exercises.clauses import Evidence
from labkit.exercises.observation import live
from labkit.exercises.time.fair_clock import MOST_SEC, FairClock
from labkit.exercises.time.hanging import find_hanging
from labkit.exercises.time.virtual_time import HANG_SEC

INT16 = 'std_msgs/msg/Int16'


def test_a_moment_in_which_nobody_worked_does_not_count() -> None:
    clock = FairClock()
    began = time.monotonic()
    time.sleep(4 * MOST_SEC)
    assert 0 < clock.seconds <= MOST_SEC
    looked = time.monotonic()
    before = clock.seconds
    while clock.seconds - before < 2 * MOST_SEC:
        time.sleep(0.001)
    assert time.monotonic() - looked >= 2 * MOST_SEC
    assert clock.seconds <= time.monotonic() - began


@contextmanager
def crowded(cpu: int) -> Iterator[None]:
    """Share one processor with busy processes."""
    code = f'import os; os.sched_setaffinity(0, {{{cpu}}}); print(flush=True)\nwhile True: pass'
    command = [sys.executable, '-c', code]
    others = [subprocess.Popen(command, stdout=subprocess.PIPE) for _ in range(4)]
    try:
        for other in others:
            assert other.stdout is not None and other.stdout.readline()
        yield
    finally:
        for other in others:
            other.kill()
            other.communicate()


@pytest.mark.slow('it is held up for seconds')
@pytest.mark.skipif(sys.platform != 'linux', reason='only Linux tells it')
def test_a_thread_that_waits_for_its_turn_has_not_had_the_time() -> None:
    cpu = min(os.sched_getaffinity(0))
    data, began, ended = bytes(4_000_000), threading.Event(), threading.Event()
    used: list[float] = []

    def work() -> None:
        os.sched_setaffinity(threading.get_native_id(), {cpu})
        began.set()
        for _ in range(200):
            hashlib.sha256(data).digest()  # others may have Python's lock meanwhile
        used.append(time.thread_time())
        ended.set()

    with crowded(cpu):
        thread = threading.Thread(target=work)
        thread.start()
        assert began.wait(60)
        start, clock = time.monotonic(), FairClock(thread)
        while not ended.wait(0.005):
            assert clock.seconds <= time.monotonic() - start
        seconds, passed = clock.seconds, time.monotonic() - start
        thread.join()
    assert seconds < passed / 2
    assert 0 < seconds < 2 * used[0]


class Held(Node):
    def __init__(self, *, blocks_at: int | None = 20) -> None:
        super().__init__('held')
        self.blocks_at = blocks_at
        self.publisher = self.create_publisher(Int16, 'numbers', 10)
        self.create_timer(0.1, self.on_timer)
        self.released = threading.Event()
        self.count = 0

    def on_timer(self) -> None:
        self.count += 1
        if self.count == self.blocks_at:
            self.released.wait()
        self.publisher.publish(Int16())


def test_a_callback_that_has_not_returned_in_time_is_named_afterwards(lab: ModuleType) -> None:
    node = lab.spin(Held())
    with Probe('test') as probe:
        life = live(probe, {'/numbers': INT16}, 10.0, nodes={'/held'})
        assert life.hanging is not None
        assert (life.hanging.node, life.hanging.callback) == ('/held', 'on_timer')
        assert life.seconds < 3.0
        node.released.set()
        lab.wait_until(lambda: node.count > 20)
        assert find_hanging() is None
        evidence = Evidence(probe)
        evidence.life = life
        with pytest.raises(Fail) as refused:
            evidence.refuse_trouble(())
    assert refused.value.expected == 'callbacks that return at once'
    assert 'on_timer of /held' in refused.value.seen


class Slow(Node):
    """Takes longer than time passes, and then does not return."""

    def __init__(self) -> None:
        super().__init__('slow')
        self.publisher = self.create_publisher(Int16, 'numbers', 10)
        self.create_timer(0.1, self.on_timer)
        self.released = threading.Event()
        self.count = 0

    def on_timer(self) -> None:
        self.count += 1
        end = time.thread_time() + 0.2
        while time.thread_time() < end or (self.count == 5 and not self.released.is_set()):
            pass


def test_a_loop_without_an_end_is_told_as_one_though_its_callback_was_slow_before(
    lab: ModuleType,
) -> None:
    node = lab.spin(Slow())
    with Probe('test') as probe:
        life = live(probe, {'/numbers': INT16}, 10.0, nodes={'/slow'})
        node.released.set()
    assert node.count == 5
    assert life.overloaded is None
    assert life.hanging is not None
    assert (life.hanging.node, life.hanging.callback) == ('/slow', 'on_timer')


def test_a_condition_that_keeps_all_callbacks_from_running_is_told(lab: ModuleType) -> None:
    lab.spin(Held(blocks_at=None))
    released = threading.Event()
    looking = threading.Event()

    def condition() -> bool:
        looking.set()
        return released.wait()

    waiter = threading.Thread(target=lab.wait_until, args=(condition,), daemon=True)
    with Probe('test') as probe:
        waiter.start()
        assert looking.wait(60)
        life = live(probe, {'/numbers': INT16}, 10.0, nodes={'/held'})
        released.set()
        waiter.join()
        evidence = Evidence(probe)
        evidence.life = life
        with pytest.raises(Fail) as refused:
            evidence.refuse_trouble(())
    assert refused.value.expected == 'callbacks of this notebook that run'


class Worker(Node):
    def __init__(self) -> None:
        super().__init__('worker')
        self.publisher = self.create_publisher(Int16, 'numbers', 10)
        self.create_timer(0.1, self.on_timer)
        self.longest = 0.0

    def on_timer(self) -> None:
        began = time.clock_gettime(time.CLOCK_MONOTONIC)
        end = time.thread_time() + 0.04
        while time.thread_time() < end:
            pass
        took = time.clock_gettime(time.CLOCK_MONOTONIC) - began
        self.longest = max(self.longest, took)
        self.publisher.publish(Int16())


@pytest.mark.slow('it is held up for seconds')
@pytest.mark.skipif(sys.platform != 'linux', reason='only there a thread can be held up so')
def test_a_callback_that_gets_no_turn_for_long_is_waited_for(lab: ModuleType) -> None:
    node = lab.spin(Worker())
    cpu, background = min(os.sched_getaffinity(0)), runtime.executor.thread.native_id
    assert background is not None
    os.sched_setaffinity(background, {cpu})
    os.setpriority(os.PRIO_PROCESS, background, 12)
    with crowded(cpu), Probe('test') as probe:
        life = live(probe, {'/numbers': INT16}, 0.3, nodes={'/worker'})
    assert life.hanging is None
    assert len(life.on('/numbers')) == 3
    assert node.longest > HANG_SEC
