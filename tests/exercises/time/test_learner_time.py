"""The one time of the learner's code: virtual in a check, and never back afterwards."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import pairwise
from types import ModuleType
from typing import Any

import pytest
from rclpy.clock import Clock, ROSClock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import Int16

from labkit.exercises import Probe
from labkit.exercises.observation import Life, live
from labkit.exercises.time.learner_time import install
from labkit.exercises.what_is_asked import Scope

TOPICS = {'/odds': 'std_msgs/msg/Int16'}


@pytest.fixture(autouse=True)
def installed(lab: ModuleType) -> None:
    install()


def see(node: str, seconds: float = 30.0) -> Life:
    with Probe('test', Scope(publishes=TOPICS)) as probe:
        return live(probe, TOPICS, seconds, nodes={node})


def times(life: Life) -> list[float]:
    return [sample.at for sample in life.on('/odds')]


def gaps(life: Life) -> set[float]:
    # What a node or thread was late with before the check it makes up for at first.
    later_ones = [at for at in times(life) if at > 1]
    return {round(later - earlier, 6) for earlier, later in pairwise(later_ones)}


class Clocked(Node):
    """A node whose fast timer looks at a clock: it publishes ten times a second."""

    def __init__(self, look: Callable[[Node], float]) -> None:
        super().__init__('clocked')
        self.publisher = self.create_publisher(Int16, 'odds', 10)
        self.look = look
        self.seen: list[float] = []
        self.due = 0.0
        self.create_timer(0.01, self.on_timer)

    def on_timer(self) -> None:
        now = self.look(self)
        # Due in the middle between two ticks: a sum of tenths is not as exact as a tick is.
        if not self.seen:
            self.due = now + 0.005
        self.seen.append(now)
        if now >= self.due:
            self.due += 0.1
            self.publisher.publish(Int16())


STEADY = Clock(clock_type=ClockType.STEADY_TIME)
SYSTEM = Clock(clock_type=ClockType.SYSTEM_TIME)
LOOKS: dict[str, Callable[[Node], float]] = {
    'steady': lambda node: STEADY.now().nanoseconds / 1e9,
    'system': lambda node: SYSTEM.now().nanoseconds / 1e9,
    'ros': lambda node: node.get_clock().now().nanoseconds / 1e9,
    'monotonic': lambda node: time.monotonic(),
    'time': lambda node: time.time(),
}


SLOW = pytest.mark.slow('several checks for one more clock')


@pytest.mark.parametrize(
    'clock',
    [pytest.param(name, marks=() if name in ('ros', 'time') else SLOW) for name in LOOKS],
)
def test_a_node_that_looks_at_a_clock_goes_on_after_a_check(lab: ModuleType, clock: str) -> None:
    node = lab.spin(Clocked(LOOKS[clock]))
    for _ in range(2):
        assert gaps(see('/clocked')) == {0.1}
        count = len(node.seen)
        assert len(lab.listen('/odds', Int16, count=3, timeout_sec=20)) == 3
        assert len(node.seen) > count
    steps = [later - earlier for earlier, later in pairwise(node.seen)]
    assert min(steps) >= 0
    assert max(steps) < 15  # and not the half minute of a check


@contextmanager
def thread(work: Callable[[Any, threading.Event], None]) -> Iterator[Any]:
    """Let a thread of the learner's work with the publisher of a node."""
    import labkit

    node = labkit.spin(Node('worker'))
    publisher = node.create_publisher(Int16, 'odds', 10)
    ended = threading.Event()
    worker = threading.Thread(target=work, args=(publisher, ended), daemon=True)
    worker.start()
    yield worker
    ended.set()
    worker.join()
    for other in threading.enumerate():
        if isinstance(other, threading.Timer):
            other.join()


def sleeps(publisher: Any, ended: threading.Event) -> None:
    while not ended.is_set():
        publisher.publish(Int16())
        time.sleep(0.1)


def waits(publisher: Any, ended: threading.Event) -> None:
    while not ended.wait(0.1):
        publisher.publish(Int16())


def takes(publisher: Any, ended: threading.Event) -> None:
    todo: queue.Queue[int] = queue.Queue()
    while not ended.is_set():
        try:
            todo.get(timeout=0.1)
        except queue.Empty:
            publisher.publish(Int16())


def keeps_pace(publisher: Any, ended: threading.Event) -> None:
    due = time.monotonic()
    while not ended.is_set():
        publisher.publish(Int16())
        due += 0.1
        time.sleep(max(0.0, due - time.monotonic()))


def sleeps_in_ros_time(publisher: Any, ended: threading.Event) -> None:
    clock = ROSClock()
    while not ended.is_set():
        publisher.publish(Int16())
        clock.sleep_for(Duration(seconds=0.1))


def sleeps_by_the_steady_clock(publisher: Any, ended: threading.Event) -> None:
    while not ended.is_set():
        publisher.publish(Int16())
        STEADY.sleep_for(Duration(seconds=0.1))


def timers(publisher: Any, ended: threading.Event) -> None:
    def again() -> None:
        if not ended.is_set():
            threading.Timer(0.1, again).start()
            publisher.publish(Int16())

    again()


WORKS = [
    sleeps,
    waits,
    takes,
    keeps_pace,
    sleeps_in_ros_time,
    sleeps_by_the_steady_clock,
    timers,
]


@pytest.mark.slow('two checks of half a minute for each')
@pytest.mark.parametrize('work', WORKS)
def test_a_thread_that_waits_is_seen_exactly(lab: ModuleType, work: Any) -> None:
    with thread(work):
        for _ in range(2):
            life = see('/worker')
            assert gaps(life) == {0.1}
            assert len(times(life)) in (299, 300)


def test_a_thread_that_stops_is_seen_to_stop(lab: ModuleType) -> None:
    def stops(publisher: Any, ended: threading.Event) -> None:
        began = time.monotonic()
        while time.monotonic() < began + 20:
            publisher.publish(Int16())
            time.sleep(0.1)

    with thread(stops):
        life = see('/worker')
    assert 15 < times(life)[-1] < 20.1


@pytest.mark.slow('a loop of seconds')
def test_a_loop_that_asks_for_the_time_again_and_again_is_no_flood(lab: ModuleType) -> None:
    def polls(publisher: Any, ended: threading.Event) -> None:
        due = time.monotonic()
        while not ended.is_set():
            if time.monotonic() >= due:
                publisher.publish(Int16())
                due += 0.1

    with thread(polls):
        life = see('/worker')
    assert life.seconds > 5
    assert all(abs(gap - 0.1) <= 0.001 for gap in gaps(life))


@pytest.mark.parametrize('kind', ClockType)
def test_a_timer_of_any_clock_is_seen_exactly(lab: ModuleType, kind: ClockType) -> None:
    clock = Clock(clock_type=kind)
    node = lab.spin(Node('worker'))
    publisher = node.create_publisher(Int16, 'odds', 10)
    timer = node.create_timer(0.1, lambda: publisher.publish(Int16()), clock=clock)
    assert timer.clock is clock
    for _ in range(2):
        assert gaps(see('/worker')) == {0.1}
        assert len(lab.listen('/odds', Int16, count=3, timeout_sec=20)) == 3


@pytest.mark.slow('several checks in kernels of their own')
def test_code_that_is_not_the_learners_has_the_computers_time(lab: ModuleType) -> None:
    lab.spin(Clocked(LOOKS['ros']))
    see('/clocked')
    from labkit.exercises.time import fair_clock

    assert time.monotonic() > fair_clock.time.monotonic.__wrapped__() + 10  # type: ignore[attr-defined]
    began = fair_clock.FairClock()
    assert began.seconds < 10


@pytest.mark.slow('two checks of half a minute for each')
@pytest.mark.parametrize('left', [1e-12, 1e-10, 4e-10, 1e-9])
def test_a_wait_for_less_than_a_nanosecond_lasts_some_time(lab: ModuleType, left: float) -> None:
    """A sum of two floats leaves as much: a wait that lasted no time would never end."""
    seen: list[int] = []

    def waits_for_little(publisher: Any, ended: threading.Event) -> None:
        while not ended.wait(0.1):
            publisher.publish(Int16())
            began = time.monotonic_ns()
            time.sleep(left)
            seen.append(time.monotonic_ns() - began)

    with thread(waits_for_little):
        see('/worker')
    assert seen and min(seen) >= 1
