"""Properties of every check, against real nodes in this process."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from itertools import pairwise
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
import rclpy
from by_hand import ByHand
from counter_node import Counter
from rclpy.node import Node
from std_msgs.msg import Int16, String

from labkit.background.runtime import runtime
from labkit.errors import LabTimeout
from labkit.exercises import Exercise, Fail, Lesson, NotAttempted, Outcome, Probe, Solution, expect
from labkit.exercises.clauses import Answers, Graph
from labkit.exercises.draws import draw_int16s
from labkit.exercises.what_is_asked import Scope

INT16 = 'std_msgs/msg/Int16'
STRING = 'std_msgs/msg/String'
# Topics that are recorded for messages sent once, before the check.
NEWS = {'publishes': {'/news': STRING}, 'shared': ['/news'], 'records': ['/news']}


def exercise(judge: Callable[[Probe], str | None] | None, **options: Any) -> Exercise:
    options = {'publishes': {'/odds': INT16}, **options}
    return Exercise(
        name='count_up',
        task='A task.',
        stage=Graph() if judge is None else ByHand(judge),
        hints=['A hint.'],
        answer=Solution('', '', 'So.'),
        **options,
    )


def counts(probe: Probe) -> str:
    source = expect.publisher(probe, '/odds')
    messages = expect.messages(probe, source, count=4)
    values = messages.values('data')
    expect.that(all(b - a == 1 for a, b in pairwise(values)), expected='1 more', seen=f'{values}')
    return expect.show(messages.values('data'))


def test_check_leaves_no_node_behind(lab: ModuleType) -> None:
    node = lab.spin(Counter())
    check = exercise(counts).check
    assert [check().outcome for _ in range(3)] == [Outcome.PASS] * 3
    assert [name for name in node.get_node_names() if 'check' in name] == []
    lab.remove(node)
    assert check().outcome is Outcome.NOT_ATTEMPTED


@pytest.mark.parametrize('error', [ValueError('no'), RuntimeError('no'), IndexError(), KeyError()])
def test_fault_of_the_check_is_said_and_never_raised(lab: ModuleType, error: Exception) -> None:
    def judge(probe: Probe) -> None:
        raise error

    verdict = exercise(judge).check()
    assert verdict.outcome is Outcome.ERROR
    assert 'a fault of the course' in repr(verdict)
    assert type(error).__name__ in verdict.trace


def test_stop_button_ends_a_check(lab: ModuleType) -> None:
    def judge(probe: Probe) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        exercise(judge).check()


def test_all_waits_share_one_limit(lab: ModuleType) -> None:
    left: list[float] = []

    def judge(probe: Probe) -> None:
        probe._end = time.monotonic() + 0.2
        for _ in range(5):
            probe.wait(lambda: False)
            left.append(probe.time_left)

    exercise(judge).check()
    assert left == [0.0] * 5


def test_time_that_a_node_needs_does_not_count(
    lab: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    left: list[float] = []

    def judge(probe: Probe) -> None:
        now = probe._end - 10.0

        def pass_time() -> None:
            nonlocal now
            now += 1.0
            left.append(probe.time_left)

        with monkeypatch.context() as patch:
            clock = SimpleNamespace(monotonic=lambda: now)
            patch.setattr('labkit.exercises.probe.time', clock)
            pass_time()
            with probe.uncounted():
                pass_time()
                with probe.uncounted():
                    pass_time()
                pass_time()
            pass_time()

    exercise(judge).check()
    assert left == pytest.approx([9.0, 9.0, 9.0, 9.0, 8.0])


def test_nothing_there_is_no_attempt(lab: ModuleType) -> None:
    verdict = exercise(counts).check()
    assert repr(verdict).startswith('NOT ATTEMPTED: count_up\n  Not attempted yet.')


def test_nodes_and_topics_of_the_lesson_are_no_attempt(lab: ModuleType) -> None:
    lab.spin(Counter('background'))
    lab.spin(Counter('demo', topic='demo'))
    asked = exercise(counts, given={'/background': '*'})
    assert asked.check().outcome is Outcome.FAIL
    Lesson('odds', '04_odds.ipynb', exercises=[asked], topics=['/demo'])
    assert asked.check().outcome is Outcome.NOT_ATTEMPTED


def test_nodes_of_earlier_exercises_are_no_attempt_where_all_roles_are_theirs() -> None:
    """Each robot of the lesson publishes on /cmd_vel, and so does the one that is asked for."""
    roles = frozenset({('publisher', '/cmd_vel'), ('subscription', '/go')})
    scope = Scope(publishes={'/cmd_vel': 'Twist'}, earlier=roles, known=frozenset({'/cmd_vel'}))

    def end(node: str, topic: str, msg_type: str) -> Any:
        return SimpleNamespace(node=node, topic=topic, msg_type=msg_type)

    done, hears = end('/square', '/cmd_vel', 'Twist'), end('/square', '/go', 'Empty')
    assert scope.attempt([done], [hears], ['/square']) == frozenset()
    new = end('/cruiser', '/cmd_vel', 'Twist')
    assert scope.attempt([done, new], [hears], []) == frozenset({'/cruiser'})


@pytest.mark.slow('waits for what hangs')
def test_callback_that_blocks_is_named(lab: ModuleType) -> None:
    release = threading.Event()

    class Blocker(Counter):
        def on_timer(self) -> None:
            release.wait()

    lab.spin(Blocker())
    try:
        verdict = exercise(counts).check()
    finally:
        release.set()
    assert verdict.outcome is Outcome.FAIL
    assert 'on_timer of /counter is still running' in verdict.seen


@pytest.mark.slow('waits for what hangs')
def test_a_callback_of_a_replaced_node_is_no_fault_of_the_new_one(lab: ModuleType) -> None:
    release, begun = threading.Event(), threading.Event()

    class Blocker(Counter):
        def on_timer(self) -> None:
            begun.set()
            release.wait()

    lab.spin(Blocker())
    assert begun.wait(60)
    try:
        lab.spin(Counter())
        verdict = exercise(counts).check()
        with pytest.raises(LabTimeout, match='on_timer of an earlier /counter is still running'):
            lab.wait_for_message('/odds', Int16, timeout_sec=0.1)
    finally:
        release.set()
    assert verdict.outcome is Outcome.ERROR, repr(verdict)
    assert 'on_timer of an earlier /counter, which has ended, still runs' in verdict.seen
    lab.wait_until(lambda: runtime.executor.running_callback() is None)
    assert exercise(counts).check().outcome is not Outcome.ERROR


def test_messages_are_seen_while_another_callback_blocks(lab: ModuleType) -> None:
    release, started = threading.Event(), threading.Event()
    blocker = Node('blocker')

    def block() -> None:
        started.set()
        release.wait()

    timer = blocker.create_timer(0.01, block)
    lab.spin(blocker)
    node = Node('looper')
    publisher = node.create_publisher(Int16, 'odds', 10)

    def work() -> None:
        value = 0
        while not release.is_set():
            value += 1
            publisher.publish(Int16(data=value))
            time.sleep(0.01)

    thread = threading.Thread(target=work)
    thread.start()
    assert started.wait(10)
    try:
        verdict = exercise(counts).check()
    finally:
        release.set()
        thread.join()
        timer.cancel()
    assert verdict.outcome is Outcome.PASS, verdict


def test_error_in_a_callback_is_shown_with_its_misconception(
    lab: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    class Raiser(Counter):
        def on_timer(self) -> None:
            self.publisher.publish(5)  # type: ignore[arg-type]

    lab.spin(Raiser())
    verdict = exercise(counts).check()
    assert verdict.outcome is Outcome.ERROR
    assert 'publish() takes a message' in verdict.why
    assert 'self.publisher.publish(5)' in verdict.trace


def test_a_wrong_type_is_told_whether_or_not_it_has_raised_yet(lab: ModuleType) -> None:
    class Wrong(Node):
        def __init__(self) -> None:
            super().__init__('wrong')
            self.publisher = self.create_publisher(String, 'odds', 10)
            self.raised = 0
            self.timer = self.create_timer(0.01, self.on_timer)

        def on_timer(self) -> None:
            self.raised += 1
            self.publisher.publish(Int16(data='1'))  # type: ignore[arg-type]

    wrong = lab.spin(Wrong())
    lab.wait_until(lambda: wrong.raised > 1, timeout_sec=20)
    verdict = exercise(counts).check()
    assert verdict.outcome is Outcome.FAIL, verdict
    assert 'A topic carries one type of message.' in verdict.why


def test_error_of_a_repaired_node_is_history(
    lab: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    class Raiser(Counter):
        def on_timer(self) -> None:
            raise ValueError('first try')

    lab.spin(Raiser())
    assert exercise(counts).check().outcome is Outcome.ERROR

    lab.remove('counter')

    class Twice(Counter):
        def on_timer(self) -> None:
            self.number += 1
            super().on_timer()

    lab.spin(Twice())
    assert exercise(counts).check().outcome is Outcome.FAIL


def test_intruder_is_named(lab: ModuleType) -> None:
    lab.spin(Counter())
    lab.spin(Counter('intruder'))
    verdict = exercise(counts).check()
    assert verdict.outcome is Outcome.FAIL
    assert '/counter in this program, /intruder in this program' in verdict.seen


def test_best_effort_publisher_is_heard_and_its_qos_seen(lab: ModuleType) -> None:
    from rclpy.qos import qos_profile_sensor_data

    class Fast(Counter):
        def __init__(self) -> None:
            super().__init__(topic='other')
            self.publisher = self.create_publisher(Int16, 'odds', qos_profile_sensor_data)

    def judge(probe: Probe) -> str:
        source = expect.publisher(probe, '/odds')
        expect.messages(probe, source, count=2)
        expect.qos(source, reliability='best_effort')
        expect.qos(source, reliability='reliable')
        return ''

    lab.spin(Fast())
    verdict = exercise(judge).check()
    assert verdict.seen == '/counter uses reliability best_effort'


def test_verdict_of_a_check_that_uses_up_what_it_checks_is_repeated(lab: ModuleType) -> None:
    judged = []

    def judge(probe: Probe) -> str:
        source = expect.publisher(probe, '/odds')
        judged.append(expect.ends_with_node(probe, source)[-1].data)
        return f'{judged[-1]}'

    asked = exercise(judge, once=True)
    lab.spin(Counter())
    first, second = asked.check(), asked.check()
    assert first.passed and str(second) == str(first) and len(judged) == 1
    lab.spin(Counter())
    assert asked.check().passed and len(judged) == 2


def test_what_was_said_before_the_check_is_recorded(lab: ModuleType) -> None:
    def judge(probe: Probe) -> str:
        said = probe.recorded['/news'].values('data')
        if not said:
            raise NotAttempted
        if said != ['once']:
            raise Fail("'once'", repr(said))
        return ''

    asked = exercise(judge, **NEWS)
    asked.begin()
    assert asked.check().outcome is Outcome.NOT_ATTEMPTED
    for said, outcome in ((['once', 'once'], Outcome.FAIL), (['once'], Outcome.PASS)):
        node = rclpy.create_node('teller')
        publisher = node.create_publisher(String, 'news', 10)
        for text in said:
            publisher.publish(String(data=text))
        node.destroy_node()
        assert asked.check().outcome is outcome
        assert asked.check().outcome is outcome


def test_recording_goes_on_after_ros_was_stopped(lab: ModuleType) -> None:
    heard: list[list[str]] = []

    def judge(probe: Probe) -> None:
        heard.append(probe.recorded['/news'].values('data'))

    asked = exercise(judge, **NEWS)
    asked.begin()
    for text in ('before', 'after'):
        node = rclpy.create_node('teller')
        node.create_publisher(String, 'news', 10).publish(String(data=text))
        node.destroy_node()
        asked.check()
        lab.stop()
        lab.start()
        asked.begin()
    assert heard == [['before'], ['after']]


def test_other_type_on_a_recorded_topic_harms_nobody(lab: ModuleType) -> None:
    node = lab.spin(Counter(topic='news'))
    asked = exercise(lambda probe: None, **NEWS)
    asked.begin()
    assert asked.check().passed
    lab.remove(node)
    asked.begin()
    assert '/news' in asked._recorder.watches()


@pytest.mark.slow('a check as long as a check may be')
def test_slow_topic_is_judged_within_the_limit(lab: ModuleType) -> None:
    class Slow(Counter):
        def __init__(self, period: float) -> None:
            super().__init__()
            for timer in list(self.timers):
                self.destroy_timer(timer)
            self.create_timer(period, self.on_timer)

    def judge(probe: Probe) -> str:
        source = expect.publisher(probe, '/odds')
        return str(len(expect.messages(probe, source, count=2)))

    lab.spin(Slow(2.0))
    assert exercise(judge).check().passed
    lab.remove('counter')
    lab.spin(Slow(60.0))
    verdict = exercise(judge).check()
    assert verdict.outcome is Outcome.FAIL and 'period is 60 s' in repr(verdict)


def test_check_that_has_no_time_left_does_not_condemn(lab: ModuleType) -> None:
    def judge(probe: Probe) -> None:
        source = expect.publisher(probe, '/odds')
        probe._end = time.monotonic() + 0.1
        expect.messages(probe, source)

    node = lab.spin(Counter())
    node.destroy_timer(next(iter(node.timers)))
    verdict = exercise(judge).check()
    assert verdict.outcome is Outcome.NOT_ATTEMPTED
    assert 'Too early to tell: no message on /odds' in verdict.text


def test_rate_is_that_of_each_publisher(lab: ModuleType) -> None:
    for name in ('first', 'second', 'third'):
        lab.spin(Counter(name))

    def judge(probe: Probe) -> str:
        source = expect.publisher(probe, '/odds')
        messages = expect.messages(probe, source, count=20)
        for stream in messages.streams():
            values = [sample.message.data for sample in stream]
            assert values == [sample.number for sample in stream]
        return str(len(messages.streams()))

    verdict = exercise(judge, shared=['/odds']).check()
    assert verdict.passed and verdict.text == '3', verdict


def test_stamps_give_the_rate_and_numbers_the_first_value(lab: ModuleType) -> None:
    node = lab.spin(Counter())
    lab.wait_until(lambda: node.number > 20, timeout_sec=30)

    def judge(probe: Probe) -> str:
        source = expect.publisher(probe, '/odds')
        messages = expect.messages(probe, source, count=3)
        numbers = [sample.number for sample in messages.samples]
        expect.that(messages.values('data') == numbers, expected=f'{numbers}', seen='others')
        return str(numbers[0])

    verdict = exercise(judge).check()
    assert verdict.passed and int(verdict.text) > 20


def test_node_that_is_not_spun_is_told_so_where_its_answer_is_wanted(lab: ModuleType) -> None:
    node = Node('evens')
    node.create_subscription(Int16, 'odds', lambda message: None, 10)
    node.create_publisher(Int16, 'evens', 10)

    answers = Answers(
        '/odds', '/evens', INT16, 'A task.', answer=lambda number: number + 1, draw=draw_int16s
    )
    evens = {'publishes': {'/evens': INT16}, 'subscribes': {'/odds': INT16}}
    verdict = exercise(None, clauses=[answers], **evens).check()
    assert verdict.outcome is Outcome.FAIL
    assert verdict.todo == 'Hand the node over: lab.spin(node)'
    node.destroy_node()


def test_an_error_in_destroy_node_is_the_learners(lab: ModuleType) -> None:
    class Rude(Counter):
        def destroy_node(self) -> None:
            self.publisher.publish('goodbye')
            super().destroy_node()

    def judge(probe: Probe) -> None:
        expect.ends_with_node(probe, expect.publisher(probe, '/odds'))

    lab.spin(Rude())
    verdict = exercise(judge).check()
    assert verdict.outcome is Outcome.ERROR
    assert 'destroy_node of /counter raised TypeError' in verdict.text
    assert exercise(judge).check().outcome is Outcome.NOT_ATTEMPTED  # it is gone all the same
