"""Time that a check lets pass: exact, for the nodes that it is meant for, undone afterwards."""

from __future__ import annotations

import contextlib
import subprocess
import threading
import time
from collections.abc import Callable
from itertools import pairwise
from types import ModuleType
from typing import Any

import psutil
import pytest
from rclpy.duration import Duration
from rclpy.exceptions import ROSInterruptException
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Int16

from labkit.background.wait import wait_for
from labkit.exercises import Exercise, Lesson, Outcome, Probe, Solution, common_mistakes, expect
from labkit.exercises.clauses import Publishes
from labkit.exercises.expect import timing
from labkit.exercises.observation import Life, Stimulus, live
from labkit.exercises.time.time_guard import MOST_SEC
from labkit.exercises.time.virtual_time import VirtualTime
from labkit.exercises.verdict import Verdict
from labkit.exercises.what_is_asked import Scope

INT16 = 'std_msgs/msg/Int16'
STRING = 'std_msgs/msg/String'


class Counter(Node):
    def __init__(self, name: str = 'counter', topic: str = 'odds', period: float = 0.2) -> None:
        super().__init__(name)
        self.publisher = self.create_publisher(Int16, topic, 10)
        self.timer = self.create_timer(period, self.on_timer)
        self.number = 1

    def on_timer(self) -> None:
        self.publisher.publish(Int16(data=self.number))
        self.number += 2


def see(topics: dict[str, str], nodes: set[str], seconds: float = 30.0, **rest: Any) -> Life:
    with Probe('test', Scope(publishes=topics)) as probe:
        return live(probe, topics, seconds, nodes=nodes, **rest)


def gaps(life: Life, topic: str) -> set[float]:
    times = [sample.at for sample in life.on(topic)]
    return {round(later - earlier, 9) for earlier, later in pairwise(times)}


def test_half_a_minute_is_seen_exactly(lab: ModuleType) -> None:
    lab.spin(Counter())
    life = see({'/odds': INT16}, {'/counter'})
    assert len(life.on('/odds')) == 150
    assert gaps(life, '/odds') == {0.2}
    assert life.seconds == 30.0


def test_a_second_look_is_as_exact_as_the_first(lab: ModuleType) -> None:
    class Twice(Counter):
        def __init__(self) -> None:
            super().__init__()
            self.create_timer(0.3, lambda: self.publisher.publish(Int16(data=0)))

    lab.spin(Twice())
    for _ in range(3):
        life = see({'/odds': INT16}, {'/counter'})
        zeros = [sample.at for sample in life.on('/odds') if sample.message.data == 0]
        assert {round(later - earlier, 9) for earlier, later in pairwise(zeros)} == {0.3}
        assert len(zeros) == 100
        odds = [sample.at for sample in life.on('/odds') if sample.message.data]
        assert {round(later - earlier, 9) for earlier, later in pairwise(odds)} == {0.2}
        assert len(odds) == 150


@pytest.mark.slow('a thousand calls a second')
def test_a_fast_timer_that_publishes_now_and_then_is_seen_exactly(lab: ModuleType) -> None:
    class Now(Counter):
        calls = 0

        def on_timer(self) -> None:
            self.calls += 1
            if self.calls % 20 == 0:
                super().on_timer()

    class Then(Counter):
        last = 0.0

        def on_timer(self) -> None:
            now = self.get_clock().now().nanoseconds / 1e9
            if now - self.last >= 0.2 - 1e-6:
                self.last = now
                super().on_timer()

    lab.spin(Now(period=0.01))
    lab.spin(Then('then', 'evens', period=0.01))
    life = see({'/odds': INT16, '/evens': INT16}, {'/counter', '/then'})
    assert gaps(life, '/odds') == {0.2}
    assert len(life.on('/evens')) >= 149
    assert gaps(life, '/evens') <= {0.2, 0.21}


def test_a_thread_with_a_rate_misses_no_beat(lab: ModuleType) -> None:
    node = lab.spin(Node('loop'))
    publisher = node.create_publisher(Int16, 'odds', 10)
    ended = threading.Event()

    def work() -> None:
        rate = node.create_rate(10)
        with contextlib.suppress(ROSInterruptException):
            while not ended.is_set():
                publisher.publish(Int16())
                rate.sleep()

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    life = see({'/odds': INT16}, {'/loop'})
    ended.set()
    thread.join()
    assert gaps(life, '/odds') == {0.1}


@pytest.mark.slow('works in real time')
def test_a_thread_with_a_rate_that_works_for_long_once_is_not_lost(lab: ModuleType) -> None:
    """A machine may be so busy that a thread gets no time for a while."""
    node = lab.spin(Node('loop'))
    publisher = node.create_publisher(Int16, 'odds', 10)
    ended = threading.Event()

    def work() -> None:
        rate = node.create_rate(10)
        number = 0
        with contextlib.suppress(ROSInterruptException):
            while not ended.is_set():
                end = time.thread_time() + (0.8 if number == 50 else 0.0)
                while time.thread_time() < end:
                    pass
                publisher.publish(Int16(data=number))
                number += 1
                rate.sleep()

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    life = see({'/odds': INT16}, {'/loop'})
    ended.set()
    thread.join()
    assert gaps(life, '/odds') == {0.1}
    assert max(sample.message.data for sample in life.on('/odds')) > 100


def test_what_a_message_sets_off_happens_at_the_same_time(lab: ModuleType) -> None:
    class Evens(Node):
        def __init__(self) -> None:
            super().__init__('evens')
            self.publisher = self.create_publisher(Int16, 'evens', 10)
            self.create_subscription(Int16, 'odds', self.on_odd, 10)

        def on_odd(self, msg: Int16) -> None:
            self.publisher.publish(Int16(data=msg.data + 1))

    lab.spin(Evens())
    lab.spin(Counter())
    life = see({'/odds': INT16, '/evens': INT16}, {'/counter', '/evens'})
    assert [s.at for s in life.on('/evens')] == [s.at for s in life.on('/odds')]
    # The counter stands still: nothing but the test comes.
    stimulus = Stimulus(1.0, '/odds', INT16, {'data': 7}, ('/evens',))
    life = see({'/odds': INT16, '/evens': INT16}, {'/evens'}, stimuli=[stimulus])
    assert [(s.at, s.message.data) for s in life.on('/evens')] == [(1.0, 8)]


def test_an_answer_of_a_thread_is_waited_for(lab: ModuleType) -> None:
    node = lab.spin(Node('slow'))
    publisher = node.create_publisher(Int16, 'evens', 10)

    def answer(msg: Int16) -> None:
        time.sleep(0.05)
        publisher.publish(Int16(data=msg.data + 1))

    node.create_subscription(
        Int16, 'odds', lambda msg: threading.Thread(target=answer, args=(msg,)).start(), 10
    )
    tests = [Stimulus(at, '/odds', INT16, {'data': int(at)}, ('/evens',)) for at in (1.0, 2.0)]
    life = see({'/odds': INT16, '/evens': INT16}, {'/slow'}, stimuli=tests)
    assert [s.message.data for s in life.on('/evens')] == [2, 3]


def test_time_is_real_again_afterwards(lab: ModuleType) -> None:
    node = lab.spin(Counter())
    see({'/odds': INT16}, {'/counter'})
    assert not node.get_clock().ros_time_is_active
    assert node.get_parameter('use_sim_time').value is False
    assert abs(node.get_clock().now().nanoseconds - time.time_ns()) < 60e9
    before = node.number
    assert lab.wait_until(lambda: node.number >= before + 6, timeout_sec=20.0) is None


def test_a_callback_that_raises_ends_it(lab: ModuleType) -> None:
    class Fragile(Counter):
        def on_timer(self) -> None:
            if self.number > 20:
                raise ValueError('too large')
            super().on_timer()

    node = lab.spin(Fragile())
    life = see({'/odds': INT16}, {'/counter'})
    assert isinstance(life.error.error, ValueError)
    assert len(life.on('/odds')) == 10
    assert not node.get_clock().ros_time_is_active


def test_a_timer_without_a_period_floods(lab: ModuleType) -> None:
    lab.spin(Counter(period=0.0))
    assert see({'/odds': INT16}, {'/counter'}).flooded


@pytest.mark.slow('several checks')
def test_output_is_counted_and_not_shown(kernel: Any) -> None:
    kernel.run(
        'import labkit as lab\nfrom rclpy.node import Node\n'
        'from labkit.exercises import Probe\nfrom labkit.exercises.observation import live\n'
        'from labkit.exercises.what_is_asked import Scope'
    )
    kernel.run(
        "node = lab.spin(Node('chatty'))\n"
        "timer = node.create_timer(1.0, lambda: (print('said'), node.get_logger().info('logged')))"
    )
    text = kernel.run(
        "with Probe('test', Scope()) as probe:\n"
        "    live(probe, {'/x': 'std_msgs/msg/String'}, 30.0, nodes={'/chatty'})\n"
        'probe.held_lines'
    ).text
    # A busy machine has time for a bar that tells how far it is.
    assert text.splitlines()[-1] == '60'


STOPPED = """
import signal, threading
import labkit as lab
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Int16
lesson = lab.lesson('odds')

class Ones(Node):
    def __init__(self):
        super().__init__('ones')
        self.publisher = self.create_publisher(Int16, 'ones', 10)
        self.create_timer(0.1, self.on_timer)
        self.calls = 0

    def on_timer(self):
        if self.get_clock().ros_time_is_active:
            self.calls += 1
            if self.calls == 20:
                # As the stop button does. A callback that sends a signal itself ends its node.
                button = (threading.main_thread().ident, signal.SIGINT)
                threading.Thread(target=signal.pthread_kill, args=button).start()
        self.publisher.publish(Int16(data=1))

node = lab.spin(Ones())
"""


def test_the_stop_button_ends_a_check_and_gives_time_back(kernel: Any) -> None:
    kernel.run(STOPPED)
    assert 'KeyboardInterrupt' in kernel.run('lesson.ones.check()').error
    assert kernel.run('node.get_clock().ros_time_is_active').text == 'False\n'
    text = kernel.run("lab.wait_for_message('/ones', Int16, timeout_sec=20).data").text
    assert text == '1\n'
    assert 'PASS: ones' in kernel.run('lesson.ones.check()').text.splitlines()


REMOTE = """
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Int16

class Counter(Node):
    def __init__(self):
        super().__init__('far')
        self.publisher = self.create_publisher(Int16, 'odds', 10)
        self.create_timer(0.2, self.on_timer)
        self.number = 1

    def on_timer(self):
        self.publisher.publish(Int16(data=self.number))
        self.number += 2

rclpy.init()
rclpy.spin(Counter())
"""


@pytest.fixture
def far(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A counter in a process of its own, in a domain that nobody else has."""
    import sys

    import labkit
    from labkit.background import domains

    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    claim = domains.claim_domain()
    labkit.start(domain_id=claim.domain_id)
    process = subprocess.Popen([sys.executable, '-c', REMOTE])
    yield process
    process.kill()
    process.wait()
    labkit.stop()


def _appears(probe: Probe, name: str) -> bool:
    return probe.wait(lambda: name in probe.node_names() and probe.publishers('/odds'), 20.0)


def test_a_node_of_another_process_follows(far: Any) -> None:
    with Probe('test', Scope(publishes={'/odds': INT16})) as probe:
        assert _appears(probe, '/far')
        life = live(probe, {'/odds': INT16}, 10.0, nodes={'/far'}, step=0.04)
        assert life.remote == ['/far']
        samples = life.on('/odds')
        period = (samples[-1].at - samples[0].at) / (samples[-1].number - samples[0].number)
        assert abs(period / 0.2 - 1) < 0.02
        # In real time again.
        watch = probe.watch('/odds', INT16)
        assert probe.wait(lambda: len(watch) >= 3, 20.0)
        assert probe.node.count_publishers('/clock') == 0


def _is_over(pid: int) -> bool:
    try:
        return psutil.Process(pid).status() == psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return True


@pytest.mark.slow('starts and kills processes')
def test_a_node_gets_its_time_back_when_the_examiner_is_killed(far: Any, script: Callable) -> None:
    import os

    result = script(
        """
import os, signal
import labkit
from labkit.exercises import Probe
from labkit.exercises.time.remote_time import RemoteTime
from labkit.exercises.what_is_asked import Scope

labkit.start()
with Probe('test', Scope(publishes={'/odds': 'std_msgs/msg/Int16'})) as probe:
    assert probe.wait(lambda: '/far' in probe.node_names(), 20.0)
    with RemoteTime(probe.spun_node, ['/far']) as remote:
        assert remote.names == ['/far']
        print(remote._guard.pid, flush=True)
        os.kill(os.getpid(), signal.SIGKILL)
""",
        ROS_AUTOMATIC_DISCOVERY_RANGE='LOCALHOST',
        ROS_DOMAIN_ID=os.environ['ROS_DOMAIN_ID'],
    )
    assert result.exit_code == -9, result.stderr
    assert wait_for(lambda: _is_over(int(result.stdout)), MOST_SEC)  # it has done its work
    with Probe('test', Scope(publishes={'/odds': INT16})) as probe:
        assert _appears(probe, '/far')
        watch = probe.watch('/odds', INT16)
        assert probe.wait(lambda: len(watch) >= 3, 20.0)


@pytest.mark.slow('several checks')
def test_time_begins_in_the_present_for_a_node_that_has_had_none(lab: ModuleType) -> None:
    """A node that notes when to act next is not late by the time that others have had."""

    class Punctual(Counter):
        def __init__(self) -> None:
            super().__init__('punctual', 'evens', 0.02)
            self.due = self.get_clock().now()

        def on_timer(self) -> None:
            if self.get_clock().now() >= self.due:
                self.due += Duration(seconds=0.1)
                super().on_timer()

    lab.spin(Counter())
    see({'/odds': INT16}, {'/counter'}, 3000.0)
    lab.spin(Punctual())
    life = see({'/evens': INT16}, {'/punctual'}, 10.0)
    assert 98 <= len(life.on('/evens')) <= 110


def test_node_whose_clock_nobody_tells_is_not_woken(lab: ModuleType) -> None:
    node = Counter()
    node.set_parameters([Parameter('use_sim_time', value=True)])
    lab.spin(node)
    assert not see({'/odds': INT16}, {'/counter'}).on('/odds')
    scope = Scope(publishes={'/odds': INT16})
    with Probe('test', scope) as probe:
        found = timing.silence(probe, expect.publisher(probe, '/odds'), 0, 1.0)
    assert found is common_mistakes.NO_CLOCK
    clock: Any = node.get_clock()
    assert clock.ros_time_is_active


def test_timers_are_called_at_once_when_time_is_real_again(lab: ModuleType) -> None:
    class Own(SingleThreadedExecutor):
        woken = 0

        def wake(self) -> None:
            self.woken += 1
            super().wake()

    counter, executor = Counter(), Own()
    executor.add_node(counter)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    with VirtualTime([counter]) as passing:
        passing.advance(1.0, lambda: True)
        before = executor.woken
    assert executor.woken > before
    executor.shutdown()
    thread.join()


class Works(Node):
    """A timer calls it four times a second, and it takes its time."""

    def __init__(self, work: Callable[[], object]) -> None:
        super().__init__('works')
        self.publisher = self.create_publisher(Int16, 'odds', 10)
        self.create_timer(0.25, self.on_timer)
        self.work = work

    def on_timer(self) -> None:
        self.publisher.publish(Int16())
        self.work()


def compute(seconds: float) -> None:
    end = time.thread_time() + seconds
    while time.thread_time() < end:
        pass


WORKS: dict[str, Callable[[], object]] = {
    'sleeps': lambda: time.sleep(0.5),
    'computes': lambda: compute(0.5),
    'waits': lambda: subprocess.run(['sleep', '0.5'], check=True),
}


def check_works(lab: ModuleType) -> Verdict:
    exercise = Exercise(
        name='works',
        task='A task.',
        clauses=[Publishes('/odds', 4.0, INT16)],
        hints=['', ''],
        answer=Solution('', '', ''),
    )
    Lesson('odds', '04_odds.ipynb', exercises=[exercise])
    return exercise.examine()


@pytest.mark.slow('several checks')
@pytest.mark.parametrize('work', WORKS)
def test_a_callback_that_takes_longer_than_the_period_of_its_timer_is_told_so(
    lab: ModuleType, work: str
) -> None:
    lab.spin(Works(WORKS[work]))
    verdict = check_works(lab)
    assert verdict.outcome is Outcome.FAIL
    assert verdict.mistake is not None and verdict.mistake.id == 'spin/outlasts'
    assert 'its timer is due every 0.25 s' in verdict.why


@pytest.mark.slow('several checks')
@pytest.mark.parametrize('work', WORKS)
def test_an_executor_of_the_learners_own_has_no_more_time(lab: ModuleType, work: str) -> None:
    executor = SingleThreadedExecutor()
    executor.add_node(Works(WORKS[work]))
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    verdict = check_works(lab)
    executor.shutdown()
    thread.join()
    assert verdict.outcome is Outcome.FAIL
    assert ('2 times too slow' if work == 'sleeps' else 'a thread is at work') in verdict.seen


@pytest.mark.slow('computes for seconds')
def test_a_check_of_callbacks_that_compute_ends_early_and_says_so(lab: ModuleType) -> None:
    node = lab.spin(Works(lambda: compute(0.15)))
    verdict = check_works(lab)
    assert verdict.passed
    seconds = float(verdict.text.split(', ')[-1].split()[0])
    assert 5 < seconds < 12
    assert node.get_clock().ros_time_is_active is False


def test_callbacks_that_take_less_than_there_is_are_not_late(lab: ModuleType) -> None:
    lab.spin(Works(lambda: time.sleep(0.2)))
    assert check_works(lab).passed
