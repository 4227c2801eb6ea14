"""A task as clauses: each has its words, and knows how to check them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from labkit.exercises import expect
from labkit.exercises.life import LIFE_SEC, Life, Sent, Stimulus, live
from labkit.exercises.verdict import Fail, NotAttempted
from labkit.exercises.watch import Sample, Watch

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['Clause', 'Evidence', 'Stream', 'Test', 'judge']

# The first test is sent after this time, and the others with so much time in between, s.
TEST_EVERY_SEC = 1.0
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
    due: bool = True


@dataclass(frozen=True)
class Stream:
    """The messages of one publisher.

    Attributes:
        topic: Full name of the topic.
        samples: The messages, in their order.
        exact: Whether their times are exact, because the node follows ROS time. Else time was
            real.
        seconds: How long it was watched, s.
    """

    topic: str
    samples: Sequence[Sample]
    exact: bool
    seconds: float

    def values(self, field_name: str) -> list[Any]:
        """Return a field of each message; dots lead to inner ones."""
        from functools import reduce

        path = field_name.split('.')
        return [reduce(getattr, path, sample.message) for sample in self.samples]

    def __len__(self) -> int:
        return len(self.samples)


@dataclass
class Evidence:
    """What a check has found out so far.

    Attributes:
        probe: The probe of the check.
        ends: The publishers and subscriptions that clauses have found, by kind, topic and node.
        life: What was seen while time passed. Before `gather`, nothing.
        streams: The messages of each publisher, by topic and node; `Publishes` puts them there.
        tests: The tests that each clause has asked for, as they were sent.
        heard: What clauses listen to by themselves, by topic. Nobody else subscribes there.
    """

    probe: Probe
    ends: dict[tuple[str, str, str], Endpoint] = field(default_factory=dict)
    life: Life = field(default_factory=Life)
    streams: dict[tuple[str, str], Stream] = field(default_factory=dict)
    tests: dict[Clause, list[Sent]] = field(default_factory=dict)
    heard: dict[str, Watch] = field(default_factory=dict)

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

    def gather(self, clauses: Sequence[Clause]) -> None:
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

    def alone(self, clause: Clause, tests: Sequence[Test], node: str) -> Evidence:
        """Let time pass for one node alone, and send it tests.

        So they don't mix with what another node under test says on the same topic.

        Args:
            clause: Who asks.
            tests: What is sent.
            node: Full name of the node.

        Returns:
            The same evidence, with what was seen now.

        Raises:
            LearnerError, Fail: As `refuse_trouble` does.
        """
        scope, stimuli = self.probe.scope, _in_turn(tests)
        topics = {**scope.publishes, **scope.subscribes}
        seconds = _seconds(stimuli) or LIFE_SEC
        life = self.live(topics, seconds, [clause], stimuli, nodes=[node])
        evidence = replace(self, life=life)
        evidence.refuse_trouble(())
        return evidence

    def refuse_trouble(self, clauses: Sequence[Clause]) -> None:
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
        if self.life.flooded:
            raise Fail(
                'callbacks that come to an end',
                f'so many callbacks within one moment that the check stopped counting, after '
                f'{self.life.seconds:.1f} s of time',
                why='A timer has no period, or a message sets off another one, which sets off the '
                'next one, without an end.',
                todo='Give the timer a period in seconds, and publish on a topic that the node '
                'does not hear itself, or do not answer what the node has said itself.',
            )

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
        clauses: Sequence[Clause],
        stimuli: Sequence[Stimulus] = (),
        nodes: Collection[str] = (),
    ) -> Life:
        """Let time pass for some nodes, as exactly as the clauses need it.

        Time passes for the nodes that clauses have found, if none are named. What else has an end
        on these topics, such as a node of an earlier exercise, stands still.
        """
        also = {'/rosout': LOG} if any('/rosout' in s.answers for s in stimuli) else {}
        period = min((clause.period for clause in clauses if clause.period), default=0.5)
        return live(
            self.probe,
            topics,
            seconds,
            stimuli=stimuli,
            also=also,
            nodes=nodes or {end.node for end in self.ends.values()},
            tick=period / 3,
            # So 45 ticks tell a rate to two percent.
            fine_sec=15 * period,
            rest=max(period, 0.1),
        )


def _in_turn(tests: Sequence[Test]) -> list[Stimulus]:
    """Return tests with the times at which they are sent, one after the other."""
    return [
        Stimulus(at=TEST_EVERY_SEC * number, **vars(test))
        for number, test in enumerate(tests, start=1)
    ]


def _seconds(stimuli: Sequence[Stimulus]) -> float:
    """Return how long it is to be looked at what comes of them, s."""
    return stimuli[-1].at + AFTER_SEC if stimuli else 0.0


class Clause(ABC):
    """One thing that a task asks for.

    Attributes:
        period: The shortest time between two messages that it is about, s; 0 if there is none.
        judges_parts: Whether it can judge a life that an error has ended early.
        own_life: Whether it lets time pass by itself. The other clauses of its task need none.
    """

    period: float = 0.0
    judges_parts = False
    own_life = False

    @property
    @abstractmethod
    def text(self) -> str:
        """What is asked for, in words of the task. The notebook says it in the same words."""

    def find(self, evidence: Evidence) -> None:
        """Look for what has to be in the graph.

        Raises:
            NotAttempted: Nothing of the learner's shows an attempt.
            Fail: It is missing, or otherwise.
        """
        return

    def tests(self, evidence: Evidence) -> Sequence[Test]:
        """Return the test messages that are to be sent."""
        return ()

    def judge(self, evidence: Evidence) -> str:
        """Judge what was seen.

        Returns:
            What was seen, in a sentence; `''` if there is nothing to say.

        Raises:
            Fail: It is not what the clause asks for.
        """
        return ''


def judge(probe: Probe, clauses: Sequence[Clause]) -> str:
    """Look for each clause in the graph, let time pass, and judge each clause.

    Args:
        probe: The probe of the check.
        clauses: What the task asks for.

    Returns:
        What was seen, in a sentence for each clause that has something to say.

    Raises:
        NotAttempted: Nothing of the learner's shows an attempt.
        Fail: A clause is not fulfilled; the exception names it.
    """
    evidence = Evidence(probe)
    said = []
    _find(clauses, evidence)
    try:
        if not any(clause.own_life for clause in clauses):
            evidence.gather(clauses)
        for clause in clauses:
            with naming(clause):
                said.append(clause.judge(evidence))
    except (Fail, NotAttempted):
        if evidence.has_ended_early():
            # That it is not there any more is the cause, and what is seen now tells it.
            _find(clauses, Evidence(probe))
        raise
    return '\n'.join(filter(None, said))


def _find(clauses: Sequence[Clause], evidence: Evidence) -> None:
    for clause in clauses:
        with naming(clause):
            clause.find(evidence)


@contextmanager
def naming(clause: Clause, *, came_first: bool = False) -> Iterator[None]:
    """Let a Fail say which clause is not fulfilled."""
    try:
        yield
    except Fail as fail:
        fail.clause = fail.clause or clause.text
        fail.came_first = came_first
        raise
