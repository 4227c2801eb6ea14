"""Some seconds of a node's life: what it published while a check let time pass, and sent it tests.

Time is virtual, see `virtual_time`. So half a minute is seen in less than a second, each message
with the exact time at which it was published, on a calm machine and on a busy one.
"""

from __future__ import annotations

import contextlib
import math
import time
from bisect import bisect_right
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from labkit.exercises.fair_clock import FairClock
from labkit.exercises.hanging import Hanging
from labkit.exercises.remote_time import RemoteTime
from labkit.exercises.verdict import LearnerError
from labkit.exercises.virtual_time import VirtualTime
from labkit.exercises.watch import Lived, Sample, Watch

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe

__all__ = ['LIFE_SEC', 'Life', 'Sent', 'Stimulus', 'live']

# How much of a node's life is looked at, s.
LIFE_SEC = 30.0
# So many events are enough, whatever the time: a fast timer is not worth a long wait.
MAX_EVENTS = 6000
# After so many messages of one topic nothing new is to be learnt.
MAX_MESSAGES = 3000
# When this is over, time passes in large steps for nodes of other processes, s of real time.
HURRY_SEC = 2.0
LARGE_STEP_SEC = 2.0
# How long a thread that keeps a rate may take to wake up upon a test, and how long an answer may
# take that comes from any thread or another process, s of real time.
THREAD_SEC = 0.3
PATIENCE_SEC = 0.8
POLL_SEC = 0.002
# What is on its way from another process has come when it was quiet for so long, and in any case
# after so long, s: some node may publish on the topic in real time, without a pause.
QUIET_SEC = 0.1
LATE_SEC = 1.0
# A test has the time at which it was sent, but for rounding, s.
SAME_SEC = 1e-6
# So many messages of another process may be on their way at once.
ON_THE_WAY = 2


@dataclass(frozen=True)
class Stimulus:
    """A test message that is to be sent.

    Attributes:
        at: When, in seconds of virtual time.
        topic: Full name of the topic.
        msg_type: Name of the type.
        fields: Its fields, see `watch.build`.
        answers: Topics on which an answer may come.
        due: Whether one is due there: then it is waited for, in real time if need be.
    """

    at: float
    topic: str
    msg_type: str
    fields: Mapping[str, Any]
    answers: Sequence[str] = ()
    due: bool = True


@dataclass(frozen=True)
class Sent:
    """A test message that was sent: the same as a `Stimulus`, with the time it was sent at."""

    at: float
    topic: str
    fields: Mapping[str, Any]


@dataclass
class Life:
    """What was seen.

    Attributes:
        seconds: How much time has passed, s.
        samples: The messages of each topic, in their order, with their times `at`.
        sent: The tests that were sent.
        flooded: Whether so many callbacks came in one moment that there was no end to see.
        hanging: The callback that did not return, if one did not.
        remote: Full names of the nodes of other processes that followed.
        strangers: How many publishers of other processes there are on each topic of a test, whose
            time was real.
        tick: How exactly times of these are known, s,
        fine_sec: for so long, s;
        rest: and how exactly at least afterwards, s.
        error: What a callback of the learner's has raised, if one has: then time stopped there.
    """

    seconds: float = 0.0
    samples: dict[str, list[Lived]] = field(default_factory=dict)
    sent: list[Sent] = field(default_factory=list)
    flooded: bool = False
    hanging: Hanging | None = None
    remote: Sequence[str] = ()
    strangers: Mapping[str, int] = field(default_factory=dict)
    tick: float = 0.0
    fine_sec: float = math.inf
    rest: float = 0.0
    error: LearnerError | None = None

    def on(self, topic: str) -> list[Lived]:
        """Return the messages of a topic."""
        return self.samples.get(topic, [])

    def besides_tests(self, topic: str) -> list[Lived]:
        """Return the messages of a topic without the tests that were sent on it."""
        tests = [sent for sent in self.sent if sent.topic == topic]
        besides = []
        for sample in self.on(topic):
            found = next((sent for sent in tests if _is_of(sample, sent)), None)
            if found is None:
                besides.append(sample)
            else:
                tests.remove(found)
        return besides

    def heard(self, topic: str, within: float) -> list[tuple[Lived, bool]]:
        """Return the messages of a topic, and whether an answer to each must have come by now.

        It is due `within` seconds. Those that must have one stand first: no other takes theirs.
        """
        found = [
            (sample, self.is_known(topic, sample) and sample.at < self.seconds - within)
            for sample in self.on(topic)
        ]
        return sorted(found, key=lambda pair: not pair[1])

    def is_known(self, topic: str, sample: Lived) -> bool:
        """Tell whether a message has reached the nodes, and when: not if a stranger has sent it.

        A stranger may have found this check and not the learner's node yet, and what it sends may
        be on its way when this ends. It may have come in the very moment of a test, too.
        """
        if not self.strangers.get(topic):
            return True
        return not any(sample is other for other in self.besides_tests(topic))

    def without_strangers(
        self,
        topic: str,
        extra: Sequence[tuple[float, Any]],
        known: Collection[Any],
        answers: int = 1,
    ) -> list[tuple[float, Any]]:
        """Leave out what may have been said upon messages that are not seen here.

        A message of another process that was on its way when time stood still belongs to the time
        before, and comes all the same; and a new subscription may be found later by that process
        than the learner's.

        Args:
            topic: Where such messages come.
            extra: What was said though nothing had come: moments and values.
            known: What was said upon tests, or could be.
            answers: How many answers one message gets.
        """
        unknown = [pair for pair in extra if pair[1] not in known]
        if len(unknown) > ON_THE_WAY * answers * self.strangers.get(topic, 0):
            return list(extra)
        return [pair for pair in extra if pair[1] in known]


def _is_of(sample: Lived, sent: Sent) -> bool:
    """Tell whether a message is a test that was sent."""
    return abs(sample.at - sent.at) < SAME_SEC and all(
        reduce(getattr, path.split('.'), sample.message) == value
        for path, value in sent.fields.items()
    )


def live(
    probe: Probe,
    topics: Mapping[str, str],
    seconds: float = LIFE_SEC,
    *,
    stimuli: Sequence[Stimulus] = (),
    also: Mapping[str, str] = MappingProxyType({}),
    nodes: Collection[str],
    tick: float = 0.05,
    fine_sec: float = math.inf,
    rest: float = 0.2,
    hurry: bool = True,
    before: Callable[[VirtualTime], None] | None = None,
    until: Callable[[float, Mapping[str, Watch]], bool] | None = None,
) -> Life:
    """Let time pass for some nodes, and write down what comes on some topics.

    Args:
        probe: The probe of the check.
        topics: The topics, with their types.
        seconds: How much time, s.
        stimuli: Tests that are sent meanwhile.
        also: Topics that are written down too, whoever has an end there.
        nodes: Full names of the nodes for which time passes. It stands still for all others of
            this process that have an end on one of the topics.
        tick: How exactly time is known for nodes of other processes, s,
        fine_sec: for so long, s;
        rest: and how exactly afterwards, s.
        hurry: Whether it may be known less exactly afterwards when it takes long. What a node says
            once in each step, as to a robot, would be lost then.
        before: Called when time stands still, before it begins to pass.
        until: Called after each event with the seconds that have passed, and what has come: it
            says whether that is enough.

    Returns:
        What was seen.
    """
    watches = {topic: probe.watch(topic, name) for topic, name in {**topics, **also}.items()}
    senders = {
        stimulus.topic: probe.sender(stimulus.topic, stimulus.msg_type) for stimulus in stimuli
    }
    moving, standing, foreign = _nodes(probe, topics, nodes)
    probe.lives_sec = seconds
    life = Life(tick=tick, fine_sec=fine_sec, rest=rest)
    moments: list[tuple[float, float]] = []
    with contextlib.ExitStack() as stack:
        stack.enter_context(probe.uncounted())
        remote = stack.enter_context(RemoteTime(probe.spun_node, foreign)) if foreign else None
        said = stack.enter_context(probe.hold_output())
        passing = VirtualTime(moving, standing, remote=remote, tick=tick)
        stack.enter_context(passing)
        life.remote = remote.names if remote is not None else ()
        life.strangers = {topic: _strangers(probe, topic, life.remote) for topic in senders}
        # What was on its way belongs to the time before.
        for watch in watches.values():
            watch.pump()
            watch.clear()
        if before is not None:
            before(passing)
        course = _Course(probe, passing, watches, moments, until)
        course.note()
        try:
            for stimulus in sorted(stimuli, key=lambda stimulus: stimulus.at):
                if not course.go(stimulus.at):
                    break
                course.send(senders[stimulus.topic], stimulus, life)
            passing.tick = tick if passing.seconds < fine_sec else rest
            course.go(min(seconds, max(fine_sec, passing.seconds)))
            passing.tick = rest
            if life.remote and hurry:
                life.rest = course.hurry(seconds)
            course.go(seconds)
            if life.remote:
                course.wait_for_late_ones()
        except LearnerError as error:
            life.error = error
        life.seconds = passing.seconds
        life.flooded, life.hanging = passing.flooded, passing.hanging
    probe.note_output(life.seconds, said)
    starts = [real for real, _ in moments]
    for topic, watch in watches.items():
        life.samples[topic] = [
            _lived(sample, moments[max(bisect_right(starts, sample.stamp) - 1, 0)][1])
            for sample in watch.samples
            # One that was published before may arrive only now.
            if sample.stamp >= starts[0]
        ]
        watch.close()
    probe.forget(watches.values())
    return life


def _lived(sample: Sample, at: float) -> Lived:
    return Lived(sample.message, sample.stamp, sample.number, at)


def _nodes(
    probe: Probe, topics: Mapping[str, str], wanted: Collection[str]
) -> tuple[list[Any], list[Any], list[str]]:
    """Return the nodes for which time passes, for which it stands, and those of elsewhere."""
    names = {
        end.node
        for topic in topics
        for end in (*probe.publishers(topic), *probe.subscriptions(topic))
    }
    here = {name: probe.node_object(name) for name in sorted({*names, *wanted})}
    found = [(name, node) for name, node in here.items() if node is not None]
    moving = [node for name, node in found if name in wanted]
    standing = [node for name, node in found if name not in wanted]
    return moving, standing, [name for name in sorted(wanted) if here[name] is None]


def _strangers(probe: Probe, topic: str, followers: Collection[str]) -> int:
    """Return how many publishers of other processes whose time is real there are on a topic."""
    from labkit.rosgraph.endpoints import publishers

    return sum(
        not probe.in_this_process(end) and end.node not in followers
        for end in publishers(probe.node, topic)
    )


@dataclass
class _Course:
    """How time passes for one life."""

    probe: Probe
    passing: VirtualTime
    watches: Mapping[str, Watch]
    moments: list[tuple[float, float]]
    until: Callable[[float, Mapping[str, Watch]], bool] | None
    events: int = 0
    patience: int = 2
    began: float = field(default_factory=time.monotonic)

    def note(self) -> None:
        """Write down which real time this moment of virtual time has."""
        self.moments.append((time.time(), self.passing.seconds))

    def go(self, at: float) -> bool:
        """Let time pass until a moment."""
        seconds = at - self.passing.seconds
        if self.events >= MAX_EVENTS or self.passing.flooded or self.passing.hanging:
            return False
        return seconds <= 0 or self.passing.advance(seconds, self._look, self.note)

    def hurry(self, at: float) -> float:
        """Let time pass until a moment, in large steps once it has taken long; return the step."""
        passing = self.passing
        usual = passing.tick
        while passing.seconds < at:
            if time.monotonic() > self.began + HURRY_SEC:
                passing.tick = max(usual, LARGE_STEP_SEC)
            if not self.go(min(at, passing.seconds + LARGE_STEP_SEC)):
                break
        return passing.tick

    def send(self, sender: Callable[..., float], stimulus: Stimulus, life: Life) -> None:
        """Send a test, and see what comes of it at once."""
        from labkit.background.patience import answer_sec

        # A test on the topic of its answers is none of them.
        before = self._count(stimulus.answers) + (stimulus.topic in stimulus.answers)
        sender(stimulus.fields)
        life.sent.append(Sent(self.passing.seconds, stimulus.topic, stimulus.fields))
        self.passing.settle()
        self._look()
        if stimulus.answers and self.passing.rates:
            self._wait_for_thread(stimulus, before)
        if not stimulus.answers or self._count(stimulus.answers) > before:
            return
        # A node that keeps what it hears for its timer answers soon in virtual time, one with a
        # thread that sleeps in real time.
        if not self.go(self.passing.seconds + 0.5) or self._count(stimulus.answers) > before:
            return
        if stimulus.due and self.patience:
            clock, longest = FairClock(), answer_sec(PATIENCE_SEC)
            while self._count(stimulus.answers) == before and clock.seconds < longest:
                time.sleep(POLL_SEC)
                self._look()
            self.patience -= self._count(stimulus.answers) == before

    def _wait_for_thread(self, stimulus: Stimulus, before: int) -> None:
        """Let a thread that a test has woken do its work before time goes on."""
        from labkit.background.patience import answer_sec

        clock, longest = FairClock(), answer_sec(THREAD_SEC)
        while self._count(stimulus.answers) == before and clock.seconds < longest:
            time.sleep(POLL_SEC)
            self._look()
        self.passing.settle_rates()
        self._look()

    def wait_for_late_ones(self) -> None:
        """Wait until nothing more comes of other processes."""
        count, end = -1, time.monotonic() + LATE_SEC
        while (now := self._count(self.watches)) != count and time.monotonic() < end:
            count = now
            time.sleep(QUIET_SEC)
            self._look()

    def _count(self, topics: Sequence[str] | Mapping[str, Watch]) -> int:
        return sum(len(self.watches[topic]) for topic in topics)

    def _look(self) -> bool:
        self.events += 1
        for watch in self.watches.values():
            watch.pump()
        self.probe.look(self.passing.seconds)
        if self.until is not None and self.until(self.passing.seconds, self.watches):
            return False
        most = max((len(watch) for watch in self.watches.values()), default=0)
        return self.events < MAX_EVENTS and most < MAX_MESSAGES
