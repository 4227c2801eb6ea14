"""A task as clauses: each has its words, and knows how to check them."""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from labkit.exercises import common_mistakes, expect
from labkit.exercises.history import Note, history, made_at
from labkit.exercises.judging import Clause, Stage, find, naming
from labkit.exercises.messages_heard import Sample, Watch
from labkit.exercises.observation import (
    ANSWERS_SOON_SEC,
    LIFE_SEC,
    STEP_SEC,
    Life,
    Sent,
    Stimulus,
    live,
)
from labkit.exercises.verdict import Fail, NotAttempted

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['Evidence', 'Graph', 'GraphClause', 'Stream', 'Test']

# The first test is sent after this time, and the others with so much time in between, s.
TEST_EVERY_SEC = 1.0
# Some come as soon as this after the one before, s; for which ones of four, is drawn.
SOON_SEC, SOON_ONE_OF = 0.005, 4
# So long it is looked at what comes after the last one, s.
AFTER_SEC = 5.0
LOG = 'rcl_interfaces/msg/Log'


@dataclass(frozen=True)
class Test:
    """A test message, see `Stimulus`; when it is sent, the evidence says."""

    topic: str
    msg_type: str
    fields: dict[str, Any]
    answers: Sequence[str] = ()
    due: int = 1


@dataclass(frozen=True)
class Stream:
    """The messages of one publisher.

    Attributes:
        topic: Full name of the topic.
        samples: The messages, in their order.
        exact: Whether their times are exact, because the node follows ROS time. Else time was
            real.
        seconds: How long it was watched, s.
        earlier: What its node has said before, as far as that is known: see `history`.
    """

    topic: str
    samples: Sequence[Sample]
    exact: bool
    seconds: float
    earlier: Sequence[Note] = ()

    def values(self, field_name: str, *, earlier: bool = False) -> list[Any]:
        """Return a field of each message; dots lead to inner ones."""
        from functools import reduce

        path = field_name.split('.')
        said = [note.message for note in self.earlier] if earlier else []
        said += [sample.message for sample in self.samples]
        return [reduce(getattr, path, message) for message in said]

    def __len__(self) -> int:
        return len(self.samples)


class GraphClause(Clause['Evidence']):
    """A clause on the learner's nodes.

    Attributes:
        period: The shortest time between two messages that it is about, s; 0 if there is none.
        judges_parts: Whether it can judge a life that an error has ended early.
        own_life: Whether it lets time pass by itself. The other clauses of its task need none.
        still: Full names of nodes of the lesson that stand still meanwhile, such as a robot on
            whose topic the tests are sent.
    """

    period: float = 0.0
    judges_parts = False
    own_life = False
    still: Collection[str] = ()

    def tests(self, evidence: Evidence) -> Sequence[Test]:
        """Return the test messages that are to be sent."""
        return ()


@dataclass
class Evidence:
    """What a check has found out so far.

    Attributes:
        probe: The probe of the check.
        ends: The publishers and subscriptions that clauses have found, by kind, topic and node.
        life: What was seen while time passed. Before `gather`, nothing.
        streams: The messages of each publisher, by topic and node; `Publishes` puts them there.
        asked: Fields of what was sent before time passed, by topic: somebody may answer only then.
        tests: The tests that each clause has asked for, as they were sent.
        heard: What clauses listen to by themselves, by topic. Nobody else subscribes there.
        partners: Full names of nodes of the lesson that the learner's ask: time passes for them.
        began: When it was begun, ns since 1970.
    """

    probe: Probe
    ends: dict[tuple[str, str, str], Endpoint] = field(default_factory=dict)
    life: Life = field(default_factory=Life)
    streams: dict[tuple[str, str], Stream] = field(default_factory=dict)
    asked: dict[str, list[dict[str, Any]]] = field(default_factory=dict)
    tests: dict[GraphClause, list[Sent]] = field(default_factory=dict)
    heard: dict[str, Watch] = field(default_factory=dict)
    partners: set[str] = field(default_factory=set)
    began: int = field(default_factory=time.time_ns)

    def publisher(self, topic: str, by: str = '') -> Endpoint:
        """Return the learner's publisher on a topic; see `expect.publisher` for what it raises."""
        key = ('publisher', topic, by)
        if key not in self.ends:
            self.ends[key] = expect.publisher(self.probe, topic, by=by)
        return self.ends[key]

    def subscription(self, topic: str, by: str = '') -> Endpoint:
        """Return the learner's subscription to a topic, likewise."""
        key = ('subscription', topic, by)
        if key not in self.ends:
            self.ends[key] = expect.subscription(self.probe, topic, by=by)
        return self.ends[key]

    def earlier(self, topic: str, node: str) -> list[Note]:
        """Return what a node of this process has said on a topic before the check, at first."""
        found = self.probe.node_object(node)
        notes = history.on(topic) or () if found is not None else ()
        return [each for each in notes if each.is_first and each.is_by(found)]

    def said_by(self, node: str, topic: str) -> list[Note] | None:
        """Return what a node of this process has said on a topic, at first and in this cell.

        None if it is not known how that began.
        """
        notes = history.on(topic)
        found = self.probe.node_object(node) if notes is not None else None
        if notes is None or found is None:
            return None
        recent = [each for each in notes if each.is_first or each.ended >= self.probe.began]
        return [each for each in recent if each.is_by(found)]

    def heard_by(self, node: str, topic: str) -> list[Note] | None:
        """Return what was published on a topic since a node of this process was made.

        None if it may have heard something else, too: its callback was called more often.
        """
        found = self.probe.node_object(node) if history.on(topic) is not None else None
        if found is None:
            return None
        ends = [end for end in found.subscriptions if end.topic_name == topic]
        # Time goes on: each call that is counted has its message among those that are read then.
        calls = [self.probe.callbacks.count(found, end) for end in ends]
        known = [count for count in calls if count is not None]
        notes = history.on(topic)
        if notes is None or not known or len(known) < len(calls):
            return None
        # It may have been made while one was being published.
        notes = [each for each in notes if each.ended >= made_at(found)]
        return notes if sum(known) <= len(notes) else None

    def gather(self, clauses: Sequence[GraphClause]) -> None:
        """Let time pass, and send what the clauses want to be sent."""
        scope = self.probe.scope
        topics = {**scope.publishes, **scope.subscribes}
        topics = {topic: name for topic, name in topics.items() if topic not in self.heard}
        asked = [(clause, test) for clause in clauses for test in clause.tests(self)]
        stimuli = _in_turn([test for _, test in asked])
        self.life = self.live(topics, max(LIFE_SEC, _seconds(stimuli)), clauses, stimuli)
        for (clause, _), sent in zip(asked, self.life.sent, strict=False):
            self.tests.setdefault(clause, []).append(sent)
        self.refuse_trouble(clauses)

    def alone(
        self,
        clause: GraphClause,
        tests: Sequence[Test],
        *nodes: str,
        also: Mapping[str, str] = MappingProxyType({}),
    ) -> Evidence:
        """Let time pass for one node alone, or for some of those that are there, and send tests.

        So they don't mix with what another node under test says on the same topic.

        Args:
            clause: Who asks.
            tests: What is sent.
            nodes: Full names of the nodes.
            also: Topics that no task names, with their types: what comes there is seen, too.

        Returns:
            The same evidence, with what was seen now.

        Raises:
            LearnerError, Fail: As `refuse_trouble` does.
        """
        scope, stimuli = self.probe.scope, _in_turn(tests)
        topics = {**scope.publishes, **scope.subscribes, **also}
        seconds = _seconds(stimuli) or LIFE_SEC
        life = self.live(topics, seconds, [clause], stimuli, nodes=nodes)
        evidence = replace(self, life=life)
        evidence.refuse_trouble(())
        return evidence

    def refuse_trouble(self, clauses: Sequence[GraphClause]) -> None:
        """Raise what has brought time to a stop before its end, if anything has.

        Args:
            clauses: What can be judged of the time before.

        Raises:
            LearnerError: A callback of the learner's has raised.
            Fail: A callback does not return, or there is no end of callbacks.
        """
        if self.life.error is not None:
            # What was wrong before is the better answer: the error may be its consequence.
            for clause in clauses:
                if clause.judges_parts:
                    with naming(clause, came_first=True):
                        clause.judge(self)
            raise self.life.error
        if self.life.hanging:
            expect.hanging(self.life.hanging)
        if self.life.overloaded:
            expect.overloaded(self.life.overloaded)
        if self.life.flooded:
            raise Fail(
                'callbacks that come to an end',
                f'so many callbacks within one moment that the check stopped counting, after '
                f'{self.life.seconds:.1f} s of time',
                common_mistakes.FLOOD,
            )

    def refuse_old_errors(self) -> None:
        """Raise what a node has raised since its cell ran: in a terminal that ends a program."""
        probe = self.probe
        nodes = {end.node for end in self.ends.values()}
        nodes |= {s.node for s in probe.all_servers() if s.service in probe.scope.serves}
        probe.callbacks.raise_old_error(probe.scope, nodes)

    def has_ended_early(self) -> bool:
        """Tell whether a process that has said nothing yet is over, while it was looked at."""
        return any(
            not self.probe.in_this_process(end)
            and not self.life.on(end.topic)
            and end.gid not in {other.gid for other in self.probe.publishers(end.topic)}
            for (kind, _, _), end in self.ends.items()
            if kind == 'publisher'
        )

    def live(
        self,
        topics: dict[str, str],
        seconds: float,
        clauses: Sequence[GraphClause],
        stimuli: Sequence[Stimulus] = (),
        nodes: Collection[str] = (),
        before: Callable[[], None] | None = None,
    ) -> Life:
        """Let time pass for some nodes, as exactly as the clauses need it.

        Time passes for the nodes that clauses have found, if none are named, and for their
        partners, if all of them are in this process. What else has an end on these topics, such as
        a node of an earlier exercise, stands still. `before` is called when it stands still for
        all of them.
        """
        names = {*(nodes or (end.node for end in self.ends.values()))}
        if all(self.probe.node_object(name) is not None for name in names):
            # What another process asks comes at some real time, when no time may pass here.
            names |= self.partners
        also = {'/rosout': LOG} if any('/rosout' in s.answers for s in stimuli) else {}
        # Who only answers needs the time no more often than for a timer that is in time.
        periods = [clause.period for clause in clauses if clause.period]
        step = min(STEP_SEC, min(periods) / 2) if periods else ANSWERS_SOON_SEC / 2
        self.probe.life = live(
            self.probe,
            topics,
            seconds,
            stimuli=stimuli,
            also=also,
            nodes=names,
            still={name for clause in clauses for name in clause.still},
            step=step,
            before=None if before is None else lambda passing: before(),
        )
        return self.probe.life


def _in_turn(tests: Sequence[Test]) -> list[Stimulus]:
    """Return tests with the times at which they are sent, one after the other.

    Some come so soon that a node which answers the newest only, or not so often, leaves one out:
    at least two that are different, and two that are alike, if there are such.
    """
    pairs = [
        (number, earlier.fields == later.fields)
        for number, (earlier, later) in enumerate(pairwise(tests), start=1)
        # A first answer that is wrong is to be told from the one to the next test.
        if number > 1
        and (earlier.topic, earlier.answers) == (later.topic, later.answers)
        and earlier.due
        and later.due
    ]
    soon = {n for n, _ in random.sample(pairs, len(pairs) // SOON_ONE_OF)}
    for alike in (True, False):
        found = [n for n, same in pairs if same is alike]
        if found and not soon.intersection(found):
            soon.add(random.choice(found))
    at, stimuli = 0.0, list[Stimulus]()
    for number, test in enumerate(tests):
        at += SOON_SEC if number in soon else TEST_EVERY_SEC
        stimuli.append(Stimulus(at=at, **vars(test)))
    return stimuli


def _seconds(stimuli: Sequence[Stimulus]) -> float:
    """Return how long it is to be looked at what comes of them, s."""
    return stimuli[-1].at + AFTER_SEC if stimuli else 0.0


class Graph(Stage[Evidence]):
    """The graph with the learner's nodes: time passes for them, and they get tests."""

    @contextmanager
    def scenes(
        self, probe: Probe, clauses: Sequence[Clause[Evidence]]
    ) -> Iterator[Sequence[Evidence]]:
        """Look for each clause in the graph, let time pass, and give what was seen."""
        asked = [clause for clause in clauses if isinstance(clause, GraphClause)]
        evidence = Evidence(probe)
        find(clauses, evidence)
        try:
            if not any(clause.own_life for clause in asked):
                evidence.gather(asked)
            yield [evidence]
            evidence.refuse_old_errors()
        except (Fail, NotAttempted):
            if evidence.has_ended_early():
                # That it is not there any more is the cause, and what is seen now tells it.
                find(clauses, Evidence(probe))
            raise
