"""What nodes have published before a check, and what is known of it."""

from __future__ import annotations

import math
import threading
import time
from types import ModuleType

import pytest
from rclpy.node import Node
from std_msgs.msg import Int16, String

from labkit.background.nodes import Origin, made
from labkit.background.runtime import runtime
from labkit.exercises import Fail, Probe
from labkit.exercises.clauses import Answers, Evidence, Logs, Publishes, Says
from labkit.exercises.history import history
from labkit.exercises.time.learner_time import learner_time
from labkit.exercises.what_is_asked import Scope

INT16 = 'std_msgs/msg/Int16'
ODDS, EVENS = '/odds', '/evens'
ADDS = Answers(ODDS, EVENS, INT16, 'add 1', answer=lambda n: n + 1, draw=lambda: [1, 1, 5])
SCOPE = Scope(publishes={EVENS: INT16}, subscribes={ODDS: INT16})


class Evens(Node):
    """Adds 1. At its beginning it says what it is told to."""

    def __init__(self, *first: int) -> None:
        super().__init__('evens')
        self.publisher = self.create_publisher(Int16, 'evens', 10)
        self.create_subscription(Int16, 'odds', self.on_odd, 10)
        for number in first:
            self.publisher.publish(Int16(data=number))

    def on_odd(self, msg: Int16) -> None:
        msg.data += 1
        self.publisher.publish(msg)


@pytest.fixture
def follows(lab: ModuleType) -> ModuleType:
    """Labkit, with a history of both topics that begins now."""
    history._notes.clear()
    history.follow([ODDS, EVENS])
    return lab


def judged(clause: Answers) -> str:
    with Probe('evens', SCOPE) as probe:
        evidence = Evidence(probe)
        clause.find(evidence)
        evidence.gather([clause])
        return clause.judge(evidence)


def test_message_is_kept_as_it_was_and_its_node_is_known(follows: ModuleType) -> None:
    node = follows.spin(Evens())
    msg = Int16(data=1)
    node.publisher.publish(msg)
    msg.data = 7
    notes = [note for note in history.on(EVENS) or () if note.is_by(node)]
    assert [note.message for note in notes] == [Int16(data=1)]
    assert notes[0].is_first


def test_all_topics_of_a_type_are_followed_where_it_is_named(lab: ModuleType) -> None:
    history._notes.clear()
    history.follow(['std_msgs/msg/String'])
    node = lab.spin(Node('free'))
    node.create_publisher(String, 'of_my_own', 10).publish(String(data='Hello'))
    node.create_publisher(Int16, 'numbers', 10).publish(Int16())
    assert [note.message.data for note in history.on('/of_my_own') or ()] == ['Hello']
    assert history.on('/numbers') is None
    history._types.clear()


def test_what_a_node_says_while_it_is_made_is_refused_whatever_else_it_has_heard(
    follows: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As where another process speaks on the topic, too.
    monkeypatch.setattr(Evidence, 'heard_by', lambda *_: None)
    follows.spin(Evens(8))
    with pytest.raises(Fail, match=r'1 more on /evens since /evens was made: data = 8'):
        judged(ADDS)


def test_what_a_node_says_at_first_and_in_the_cell_of_the_check_is_known(
    follows: ModuleType,
) -> None:
    node = follows.spin(Evens())
    made.add(node, Origin(runtime.console.current_cell()))  # as in a notebook
    node.publisher.publish(Int16(data=1))
    made.origins[node].cell.ended = True  # another cell is run: the learner tries something out
    node.publisher.publish(Int16(data=2))
    with Probe('evens', SCOPE) as probe:  # in a cell of its own
        probe.began = time.time_ns()
        node.publisher.publish(Int16(data=3))
        said = Evidence(probe).said_by('/evens', EVENS)
    assert [note.message.data for note in said or ()] == [1, 3]


def test_node_that_has_only_answered_is_right(follows: ModuleType) -> None:
    follows.spin(Evens())
    speaks = follows.spin(Node('speaks')).create_publisher(Int16, 'odds', 10)
    for number in (7, 7, 9):
        speaks.publish(Int16(data=number))
    assert judged(ADDS)


def test_node_that_has_said_something_else_before_is_refused(follows: ModuleType) -> None:
    follows.spin(Evens(8, 8))
    with pytest.raises(Fail, match='2 more on /evens since /evens was made: data = 8, 8') as found:
        judged(ADDS)
    assert found.value.mistake is not None
    assert found.value.mistake.id == 'answers/unasked'


def test_what_somebody_else_may_have_caused_is_not_refused(lab: ModuleType) -> None:
    """Nobody has noted yet what the node hears, as of another process."""
    history._notes.clear()
    history.follow([EVENS])
    node = lab.spin(Evens())
    node.publisher.publish(Int16(data=8))
    speaks = lab.spin(Node('speaks')).create_publisher(Int16, 'odds', 10)
    speaks.publish(Int16(data=7))
    lab.wait_until(lambda: len(notes_of(node)) == 2)
    history.follow([ODDS])
    assert judged(ADDS)


def test_node_that_makes_up_for_a_late_beginning_is_right(follows: ModuleType) -> None:
    node = Ones()
    made.add(node, Origin(runtime.console.current_cell()))  # as in a notebook
    time.sleep(1.0)  # as on a busy machine

    def make_up() -> None:
        for _ in range(10):
            node.publisher.publish(Int16(data=1))

    thread = threading.Thread(target=make_up)
    thread.start()
    thread.join()
    follows.spin(node)
    with Probe('ones', SCOPE) as probe:
        evidence, clause = Evidence(probe), Publishes(EVENS, 10.0, INT16)
        clause.find(evidence)
        evidence.gather((clause,))
        assert clause.judge(evidence)


class Ear(Node):
    """Logs what it hears, and once more by a timer."""

    def __init__(self, more: str) -> None:
        super().__init__('ear')
        self.more, self.heard = more, 0
        self.create_subscription(String, 'chatter', self.on_message, 10)
        self.timer = self.create_timer(0.01, self.on_timer)

    def log(self, text: str) -> None:
        self.get_logger().info(text)
        runtime.console.on_log('ear', text)  # as in a notebook

    def on_timer(self) -> None:
        if self.heard:
            self.timer.cancel()
            self.log(self.more)

    def on_message(self, msg: String) -> None:
        self.heard += 1
        self.log(f'I heard {msg.data}')


@pytest.mark.parametrize(('more', 'refused'), [('I am ready', True), ('So it said hello', False)])
def test_line_of_a_timer_from_before_the_check_is_seen(
    lab: ModuleType, more: str, refused: bool
) -> None:
    history.follow(['/chatter'])
    clause = Logs('/chatter', 'std_msgs/msg/String', 'log it', draw=lambda: ['Zoe', 'Ada'])
    node = Ear(more)
    made.add(node, Origin(runtime.console.current_cell()))  # as in a notebook
    lab.spin(node)
    speaks = lab.spin(Node('speaks')).create_publisher(String, 'chatter', 10)
    speaks.publish(String(data='hello'))
    lab.wait_until(lambda: history.lines_of(node))
    with Probe('ear', Scope(subscribes={'/chatter': 'std_msgs/msg/String'})) as probe:
        evidence = Evidence(probe)
        clause.find(evidence)
        evidence.gather([clause])
        if not refused:
            assert clause.judge(evidence)
            return
        with pytest.raises(Fail, match="1 line more, before the check: 'I am ready'"):
            clause.judge(evidence)


class Late(Node):
    """Publishes ten times a second by the clock, but is held up until a check lets time pass."""

    def __init__(self, before: int, more: int) -> None:
        super().__init__('ones')
        self.publisher = self.create_publisher(Int16, 'evens', 10)
        self.create_timer(0.02, self.on_timer)
        self.due, self.before, self.more = math.inf, before, more

    def on_timer(self) -> None:
        if learner_time.passed is None and len(notes_of(self)) >= self.before:
            return
        if time.monotonic() >= self.due:
            self.due += 0.1
        elif self.more:
            self.more -= 1
        else:
            return
        self.publisher.publish(Int16(data=1))


@pytest.mark.slow('several checks')
@pytest.mark.parametrize('before', [0, 1])
@pytest.mark.parametrize(('more', 'seen'), [(0, ''), (4, 'in between')])
def test_node_that_was_held_up_makes_up_for_that_alone(
    follows: ModuleType, before: int, more: int, seen: str
) -> None:
    node = Late(before, more)
    made.add(node, Origin(runtime.console.current_cell()))  # as in a notebook
    node.due = time.monotonic()
    follows.spin(node)
    follows.wait_until(lambda: len(notes_of(node)) == before)
    time.sleep(0.5)
    with Probe('ones', SCOPE) as probe:
        evidence, clause = Evidence(probe), Publishes(EVENS, 10.0, INT16)
        clause.find(evidence)
        evidence.gather((clause,))
        if not seen:
            assert clause.judge(evidence)
            return
        with pytest.raises(Fail) as found:
            clause.judge(evidence)
    assert seen in found.value.seen


def notes_of(node: Node) -> list[int]:
    return [note.message.data for note in history.on(EVENS) or () if note.is_by(node)]


class Ones(Node):
    """Publishes ten times a second, and something at its beginning."""

    def __init__(self, *first: int) -> None:
        super().__init__('ones')
        self.publisher = self.create_publisher(Int16, 'evens', 10)
        self.create_timer(0.1, self.on_timer)
        for number in first:
            self.publisher.publish(Int16(data=number))

    def on_timer(self) -> None:
        self.publisher.publish(Int16(data=1))


@pytest.mark.slow('it goes by real time, and needs a quiet machine')
def test_burst_of_a_node_that_took_long_to_make_is_no_making_up(follows: ModuleType) -> None:
    node = Ones()
    made.add(node, Origin(runtime.console.current_cell()))  # as in a notebook
    time.sleep(2.0)  # its `__init__` goes on, as on a busy machine
    # More than a busy machine takes a second for, and fewer than two seconds would allow.
    for _ in range(18):
        node.publisher.publish(Int16(data=1))
    follows.spin(node)
    with Probe('ones', SCOPE) as probe:
        evidence, clause = Evidence(probe), Publishes(EVENS, 10.0, INT16)
        clause.find(evidence)
        evidence.gather((clause,))
        with pytest.raises(Fail, match='messages in its first'):
            clause.judge(evidence)


@pytest.mark.parametrize(
    ('first', 'seen'),
    [
        ((), ''),
        ((1,), ''),
        ((1,) * 200, 'messages in its first'),
        ((0,), 'before the check'),
    ],
)
def test_what_a_node_says_at_its_beginning_counts(
    follows: ModuleType, first: tuple[int, ...], seen: str
) -> None:
    follows.spin(Ones(*first))
    clauses = (Publishes(EVENS, 10.0, INT16), Says(EVENS, 1))
    with Probe('ones', SCOPE) as probe:
        evidence = Evidence(probe)
        clauses[0].find(evidence)
        evidence.gather(clauses)
        if not seen:
            assert [clause.judge(evidence) for clause in clauses]
            return
        with pytest.raises(Fail) as found:
            for clause in clauses:
                clause.judge(evidence)
    assert seen in found.value.seen
