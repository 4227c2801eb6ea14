"""Some seconds of a node's life: what it published while a check let time pass, and sent it tests.

Time is virtual, see `virtual_time`. So half a minute is seen in less than a second, each message
with the exact time at which it was published, on a calm machine and on a busy one.
"""

from __future__ import annotations

import contextlib
import math
import time
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from itertools import zip_longest
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from labkit.background.wait import wait_for
from labkit.errors import printable
from labkit.exercises.messages_heard import Lived, Sample, Watch
from labkit.exercises.time.hanging import Hanging
from labkit.exercises.time.remote_time import RemoteTime
from labkit.exercises.time.virtual_time import VirtualTime
from labkit.exercises.verdict import LearnerError
from labkit.views.time_line import Event, TimeLine

if TYPE_CHECKING:
    from labkit.asking.traffic import Publication
    from labkit.exercises.probe import Probe

__all__ = ['LIFE_SEC', 'Life', 'Sent', 'Stimulus', 'Stray', 'live']

# Who has sent a message, where it is no node of the notebook.
BY_CHECK, ANOTHER = 'this check', 'another process'
# So many messages of a time line have their texts beside it, each so long.
SHOWN, LONGEST = 24, 120
# How much of a node's life is looked at, s.
LIFE_SEC = 30.0
# So many events are enough, whatever the time: a fast timer is not worth a long wait.
MAX_EVENTS = 6000
# After so many messages of one topic nothing new is to be learnt.
MAX_MESSAGES = 3000
# How often nodes of other processes are told the time, s: their timers are not known here.
STEP_SEC = 0.05
# A node that keeps what it hears for its timer answers within this time, s.
ANSWERS_SOON_SEC = 0.5
# An answer of another process that keeps a time of its own is waited for so long, s of real time,
# until so many did not come.
ANSWER_SEC = 3.0
PATIENCE = 2
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
        due: How many are due there: they are waited for, in real time if need be.
    """

    at: float
    topic: str
    msg_type: str
    fields: Mapping[str, Any]
    answers: Sequence[str] = ()
    due: int = 1


@dataclass(frozen=True)
class Sent:
    """A test message that was sent: the same as a `Stimulus`, with the time it was sent at."""

    at: float
    topic: str
    fields: Mapping[str, Any]


@dataclass(frozen=True)
class Stray:
    """A message that a callback has published with the publisher of another node.

    Attributes:
        node: Full name of the node of the callback.
        callback: Its name.
        topic: Where the message went.
        owner: Full name of the node of the publisher.
    """

    node: str
    callback: str
    topic: str
    owner: str


@dataclass
class Life:
    """What was seen.

    Attributes:
        seconds: How much time has passed, s.
        samples: The messages of each topic, in their order, with their times `at`. That is below
            0 for those that came just before: the answers to them may come later.
        sent: The tests that were sent.
        flooded: Whether so many callbacks came in one moment that there was no end to see.
        hanging: The callback that did not return, if one did not.
        overloaded: The callback or thread that worked for longer than time passed, likewise.
        overrun: The callback of a timer that slept for longer than its period, likewise.
        remote: Full names of the nodes of other processes that followed.
        lost: Those of them that have stopped to answer on the way.
        real: Full names of the nodes of other processes whose time was real, at the end at least.
        strangers: How many publishers of other processes there are on each topic of a test, whose
            time was real.
        step: How exactly times of these are known, s.
        error: What a callback of the learner's has raised, if one has: then time stopped there.
        began: When time began to pass, ns since 1970.
        since: From when on all topics were listened to, s, below 0: of a message that came before,
            the answer may have been missed.
        strays: What callbacks have published with the publisher of another node.
    """

    seconds: float = 0.0
    samples: dict[str, list[Lived]] = field(default_factory=dict)
    sent: list[Sent] = field(default_factory=list)
    flooded: bool = False
    hanging: Hanging | None = None
    overloaded: Hanging | None = None
    overrun: Hanging | None = None
    remote: Sequence[str] = ()
    lost: Sequence[str] = ()
    real: Sequence[str] = ()
    strangers: Mapping[str, int] = field(default_factory=dict)
    step: float = 0.0
    error: LearnerError | None = None
    began: int = 0
    since: float = -math.inf
    strays: Sequence[Stray] = ()

    def on(self, topic: str, *, before: bool = False) -> list[Lived]:
        """Return the messages of a topic, if asked for with those that came just before."""
        return [s for s in self.samples.get(topic, ()) if before or s.at >= 0]

    def time_line(self, at: float | None) -> TimeLine | None:
        """Return what was seen as a time line; None if nothing was.

        Args:
            at: When it went wrong, s; None if it did not, or at no single moment.
        """
        found = [(sent.at, sent.topic, BY_CHECK, sent.fields) for sent in self.sent]
        for topic in self.samples:
            for sample in self.besides_tests(topic):
                by = sample.node or ANOTHER
                if topic == '/rosout':  # ROS itself publishes there
                    by = f'/{sample.message.name.replace(".", "/")}'
                found.append((sample.at, topic, by, sample.message))
        found.sort(key=lambda each: each[0])
        lanes: dict[tuple[str, str], list[float]] = {}
        for moment, topic, by, _ in found:
            lanes.setdefault((topic, by), []).append(moment)
        first = max(0, bisect_left(found, at, key=lambda each: each[0]) - SHOWN // 4) if at else 0
        events = [
            Event(moment, topic, by, _in_words(message))
            for moment, topic, by, message in found[first : first + SHOWN]
        ]
        return TimeLine(self.seconds, lanes, events, at) if found else None

    def besides_tests(self, topic: str, *, before: bool = False) -> list[Lived]:
        """Return the messages of a topic without the tests that were sent on it."""
        tests = [sent for sent in self.sent if sent.topic == topic]
        besides = []
        for sample in self.on(topic, before=before):
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
            (sample, self.is_known(topic, sample) and 0 <= sample.at < self.seconds - within)
            for sample in self.on(topic, before=True)
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
    ) -> list[tuple[float, Any]]:
        """Leave out what may have been said upon messages that are not seen here.

        A message of another process that was on its way when time stood still belongs to the time
        before, and comes all the same; and a new subscription may be found later by that process
        than the learner's.

        Args:
            topic: Where such messages come.
            extra: What was said though nothing had come: moments and values.
            known: What was said upon tests, or could be.
        """
        unknown = [pair for pair in extra if pair[1] not in known]
        if len(unknown) > ON_THE_WAY * self.strangers.get(topic, 0):
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
    still: Collection[str] = (),
    step: float = STEP_SEC,
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
        still: Full names of nodes of the lesson for which it stands still, too.
        step: How often nodes of other processes are told the time, s. So exactly their times are
            known.
        before: Called when time stands still, before it begins to pass.
        until: Called after each event with the seconds that have passed, and what has come: it
            says whether that is enough.

    Returns:
        What was seen.
    """
    from labkit.asking.traffic import publications

    life = Life()
    moments: list[tuple[float, float]] = []
    with contextlib.ExitStack() as stack:
        published = stack.enter_context(publications())
        watches = {topic: probe.watch(topic, name) for topic, name in {**topics, **also}.items()}
        senders = {
            stimulus.topic: probe.sender(stimulus.topic, stimulus.msg_type) for stimulus in stimuli
        }
        moving, standing, foreign = _nodes(probe, topics, nodes, still)
        probe.lives_sec = seconds
        stack.enter_context(probe.uncounted())
        _wait_until_heard(probe, watches, foreign)
        remote = stack.enter_context(RemoteTime(probe.spun_node, foreign)) if foreign else None
        since = time.time()
        said = stack.enter_context(probe.hold_output())
        passing = VirtualTime(moving, standing, remote=remote, step=step, work_sec=probe.work_sec)
        stack.enter_context(passing)
        if remote is not None and remote.names:
            life.remote, life.step = remote.names, step
            probe.moved_clocks.update(remote.names)
        life.strangers = {topic: _strangers(probe, topic, life.remote) for topic in senders}
        # What was on its way belongs to the time before.
        earlier = {}
        for topic, watch in watches.items():
            watch.pump()
            earlier[topic] = watch.clear()
        if before is not None:
            before(passing)
        # Only what another process does may come in real time.
        course = _Course(
            probe, passing, watches, moments, until, remote, PATIENCE if foreign else 0
        )
        course.note()
        life.began, life.since = time.time_ns(), since - moments[0][0]
        try:
            in_turn = sorted(stimuli, key=lambda stimulus: stimulus.at)
            for stimulus, following in zip_longest(in_turn, in_turn[1:]):
                if not course.go(stimulus.at):
                    break
                course.send(senders[stimulus.topic], stimulus, life)
                if following is None or following.at > stimulus.at + ANSWERS_SOON_SEC:
                    course.wait_for_answers(stimulus.answers)
            course.go(seconds)
            course.catch_up()
        except LearnerError as error:
            life.error = error
        if remote is not None:
            life.real = [name for name in foreign if name not in remote.names]
            life.lost = [name for name in life.remote if name not in remote.names]
            if remote.slow:
                # What it does in its own time is another matter.
                life.remote, life.lost = remote.names, ()
        life.seconds = passing.seconds
        life.flooded, life.hanging = passing.flooded, passing.hanging
        life.overloaded, life.overrun = passing.overloaded, passing.overrun
        probe.work_sec -= passing.worked
    life.strays = _strays(published)
    probe.note_output(life.seconds, said)
    for topic, watch in watches.items():
        samples = [*earlier[topic], *watch.samples]
        authors = _authors(topic, published)
        life.samples[topic] = [_lived(sample, moments, authors) for sample in samples]
        watch.close()
    probe.forget(watches.values())
    return life


def _owners() -> dict[Any, str]:
    """Return the publishers of this process with the full names of their nodes."""
    from labkit.background.nodes import existing_nodes, full_name

    nodes = [(node, full_name(node)) for node in existing_nodes()]
    return {publisher: name for node, name in nodes for publisher in node.publishers}


def _strays(published: Sequence[Publication]) -> list[Stray]:
    """Return what callbacks have published with the publisher of another node."""
    of = _owners()
    return [
        Stray(*each.caller, each.publisher.topic_name, of[each.publisher])
        for each in published
        if each.caller is not None
        and each.publisher in of
        and each.caller[0] != of[each.publisher]
    ]


def _authors(topic: str, published: Sequence[Publication]) -> list[tuple[float, float, str]]:
    """Return from when to when a node of this process has published on a topic, s since 1970."""
    of = _owners()
    return [
        (each.began * 1e-9, each.ended * 1e-9, of[each.publisher])
        for each in published
        if each.publisher in of and each.publisher.topic_name == topic
    ]


def _lived(
    sample: Sample,
    moments: Sequence[tuple[float, float]],
    authors: list[tuple[float, float, str]],
) -> Lived:
    """Give a message its author, and the virtual time when it was published; before it, below 0.

    Args:
        sample: The message.
        moments: Which virtual time began when.
        authors: What `_authors` has returned. It is taken out here.
    """
    index = bisect_right(moments, sample.stamp, key=lambda moment: moment[0])
    at = moments[index - 1][1] if index else sample.stamp - moments[0][0]
    stamp = sample.stamp
    found = next((a for a in authors if a[0] - SAME_SEC <= stamp <= a[1] + SAME_SEC), None)
    if found is not None:
        authors.remove(found)
    return Lived(sample.message, stamp, sample.number, at, found[2] if found is not None else '')


def _nodes(
    probe: Probe, topics: Mapping[str, str], wanted: Collection[str], still: Collection[str]
) -> tuple[list[Any], list[Any], list[str]]:
    """Return the nodes for which time passes, for which it stands, and those of elsewhere."""
    names = {
        end.node
        for topic in topics
        for end in (*probe.publishers(topic), *probe.subscriptions(topic))
    }
    here = {name: probe.node_object(name) for name in sorted({*names, *wanted, *still})}
    found = [(name, node) for name, node in here.items() if node is not None]
    moving = [node for name, node in found if name in wanted]
    standing = [node for name, node in found if name not in wanted]
    return moving, standing, [name for name in sorted(wanted) if here[name] is None]


def _wait_until_heard(probe: Probe, topics: Collection[str], followers: Collection[str]) -> None:
    """Wait until nodes of other processes that speak on these topics know that the check listens.

    Until then a message of theirs comes to the learner's node and not to the check. A process
    takes what is new in the order in which it was made: one that answers a client knows the
    subscriptions that were made before.
    """
    from labkit.asking.service_calls import wait_until_spun
    from labkit.rosgraph.endpoints import publishers

    ends = (end for topic in topics for end in publishers(probe.node, topic))
    names = {end.node for end in ends if not probe.in_this_process(end)}
    for name in sorted(names.difference(followers)):
        wait_until_spun(probe.spun_node, name)


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
    remote: RemoteTime | None = None
    patience: int = 0
    events: int = 0
    # So many answers are due, and so many messages are there when they have come.
    due: int = 0
    wanted: int = 0

    def note(self) -> None:
        """Write down which real time this moment of virtual time has."""
        self.moments.append((time.time(), self.passing.seconds))

    def go(self, at: float) -> bool:
        """Let time pass until a moment."""
        seconds = at - self.passing.seconds
        if self.events >= MAX_EVENTS or self.passing.stopped:
            return False
        return seconds <= 0 or self.passing.advance(seconds, self._look, self.note)

    def send(self, sender: Callable[..., float], stimulus: Stimulus, life: Life) -> None:
        """Send a test, and see what comes of it at once."""
        if not self.due:
            self.wanted = self._count(stimulus.answers)
        # A test on the topic of its answers is none of them.
        self.wanted += stimulus.topic in stimulus.answers
        if stimulus.answers:
            self.wanted, self.due = self.wanted + stimulus.due, self.due + stimulus.due
        sender(stimulus.fields)
        life.sent.append(Sent(self.passing.seconds, stimulus.topic, stimulus.fields))
        self.passing.settle()
        self._look()

    def wait_for_answers(self, topics: Sequence[str]) -> None:
        """Let time pass until those come that are due, in real time if need be."""
        due, self.due = self.due, 0

        def answered() -> bool:
            self._look()
            return self._count(topics) >= self.wanted

        if due:
            self.catch_up()
        if not due or answered() or not self.go(self.passing.seconds + ANSWERS_SOON_SEC):
            return
        if self.patience and not (self.remote and self.remote.is_deaf) and not answered():
            self.patience -= not wait_for(answered, ANSWER_SEC)

    def _count(self, topics: Sequence[str] | Mapping[str, Watch]) -> int:
        return sum(len(self.watches[topic]) for topic in topics)

    def catch_up(self) -> None:
        """Wait for nodes whose time is real: what has reached them, they may do much later."""
        if self.remote is not None:
            self.remote.catch_up()
        for watch in self.watches.values():
            watch.pump()

    def _look(self) -> bool:
        self.events += 1
        for watch in self.watches.values():
            watch.pump()
        self.probe.look(self.passing.seconds)
        if self.until is not None and self.until(self.passing.seconds, self.watches):
            return False
        most = max((len(watch) for watch in self.watches.values()), default=0)
        return self.events < MAX_EVENTS and most < MAX_MESSAGES


def _in_words(message: Any) -> str:
    """Return a message of a time line, or the fields of a test, in a line."""
    from labkit.rosgraph.message_yaml import to_yaml

    if isinstance(message, Mapping):
        text = ', '.join(f'{name}: {value}' for name, value in message.items())
    elif hasattr(message, 'msg') and hasattr(message, 'level'):  # a line of a log
        text = message.msg
    else:
        text = to_yaml(message, truncate_length=LONGEST, no_arr=True)
    text = printable(' '.join(text.split()))
    return text if len(text) <= LONGEST else f'{text[: LONGEST - 3]}...'
