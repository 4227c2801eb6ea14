"""The stop button during a check: it ends the check, and nothing of the check is left."""

from __future__ import annotations

import random
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from types import ModuleType
from typing import Any

import pytest
from rclpy.node import Node
from std_msgs.msg import Int16

from labkit import stop_button
from labkit.background.nodes import existing_nodes
from labkit.exercises import Probe
from labkit.exercises.observation import Life, live
from labkit.exercises.what_is_asked import Scope

TOPICS = {'/odds': 'std_msgs/msg/Int16'}


class Slow(Node):
    """A node whose callback does not return for a while, once a check lets time pass."""

    def __init__(self) -> None:
        super().__init__('slow')
        self.publisher = self.create_publisher(Int16, 'odds', 10)
        self.create_timer(0.05, self.on_timer)
        self.is_slow = threading.Event()
        self.begun = threading.Event()
        self.released = threading.Event()
        self.is_slow.set()

    def on_timer(self) -> None:
        clock: Any = self.get_clock()
        if self.is_slow.is_set() and clock.ros_time_is_active:
            self.begun.set()
            self.released.wait(60)
        self.publisher.publish(Int16())


@contextmanager
def pressed(after: threading.Event, timeout_sec: float) -> Iterator[None]:
    """Press the stop button once, after an event or in time, unless the `with` block has ended."""
    main, ended = threading.get_ident(), threading.Event()

    def press() -> None:
        after.wait(timeout_sec)
        if not ended.is_set():
            signal.pthread_kill(main, signal.SIGINT)

    button = threading.Thread(target=press)
    button.start()
    try:
        yield
    finally:
        ended.set()
        after.set()
        button.join()


def see() -> Life:
    with Probe('test', Scope(publishes=TOPICS)) as probe:
        return live(probe, TOPICS, nodes={'/slow'})


def left() -> dict[str, Any]:
    """Return the current state of all that a check changes."""
    clocks: list[Any] = [node.get_clock() for node in existing_nodes()]
    return {
        'clocks': [clock.ros_time_is_active for clock in clocks],
        'nodes': sorted(node.get_fully_qualified_name() for node in existing_nodes()),
        'switch interval': sys.getswitchinterval(),
        'handler': signal.getsignal(signal.SIGINT),
    }


def test_stop_while_a_callback_hangs_leaves_nothing_behind(lab: ModuleType) -> None:
    node = lab.spin(Slow())
    before = left()
    with pytest.raises(KeyboardInterrupt), pressed(node.begun, 60):
        see()
    assert left() == before
    node.is_slow.clear()
    node.released.set()
    assert len(lab.listen('/odds', Int16, count=5, timeout_sec=30)) == 5


@pytest.mark.slow('it stops a check many times')
def test_stop_at_any_moment_of_a_check_leaves_nothing_behind(lab: ModuleType) -> None:
    node = lab.spin(Slow())
    node.is_slow.clear()
    node.released.set()
    draw = random.Random(1)
    before = left()
    began = time.monotonic()
    see()
    took = time.monotonic() - began
    stopped = 0
    for _ in range(20):
        try:
            with pressed(threading.Event(), draw.uniform(0, took)):
                see()
        except KeyboardInterrupt:
            stopped += 1
        assert left() == before
    assert stopped > 0
    times = [sample.at for sample in see().on('/odds')]
    assert {round(later - earlier, 9) for earlier, later in pairwise(times)} == {0.05}
    assert len(times) >= 599


def test_it_is_heard_where_something_waits_and_once_only() -> None:
    done: list[str] = []
    with pytest.raises(KeyboardInterrupt), stop_button.held():
        try:
            signal.raise_signal(signal.SIGINT)
            done.append('a step')
            stop_button.pause(0)
            done.append('another step')
        finally:
            signal.raise_signal(signal.SIGINT)
            stop_button.pause(0)
            done.append('undone')
    assert done == ['a step', 'undone']


def test_it_is_heard_at_the_latest_in_the_end() -> None:
    with pytest.raises(KeyboardInterrupt), stop_button.held():
        signal.raise_signal(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_it_stays_ignored_where_it_is_ignored() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with stop_button.held():
            signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)


def test_code_of_others_is_interrupted_at_once() -> None:
    with pytest.raises(KeyboardInterrupt), stop_button.held(), stop_button.heard_at_once():
        signal.raise_signal(signal.SIGINT)
        pytest.fail('it went on')


def test_what_undoes_something_may_wait() -> None:
    done: list[str] = []
    with pytest.raises(KeyboardInterrupt), stop_button.held():
        with stop_button.undoing():
            signal.raise_signal(signal.SIGINT)
            stop_button.pause(0)
            done.append('undone')
        stop_button.pause(0)
        pytest.fail('it went on')
    assert done == ['undone']
