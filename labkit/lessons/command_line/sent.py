"""What was sent to a topic: waited for until it is all there, attempt by attempt.

A message does not say who has sent it, but as which one: every publisher counts from 1.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import combinations, pairwise
from statistics import mean, median
from typing import TYPE_CHECKING, NoReturn

from labkit.exercises import (
    Clause,
    Fail,
    NotAttempted,
    Probe,
    Stage,
    common_mistakes,
    words_of,
)
from labkit.exercises.judging import naming
from labkit.exercises.messages_heard import Sample
from labkit.exercises.sent_once import Recording
from labkit.exercises.what_is_asked import PUBLISHER, Role
from labkit.lessons.command_line.last_command import (
    explain_last_command,
    forget_commands,
    other_topic,
)

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = [
    'TOLERANCE',
    'Commands',
    'OnTopic',
    'Sent',
    'is_every',
    'messages_at_once',
    'newest_run',
    'period',
]

WORDS = words_of(__file__)

Samples = Sequence[Sample]

# Nothing more comes after so long: if all is there, or nobody is who could send it; else, s.
GONE_SEC = 0.3
SILENT_SEC = 1.2
# So long a check waits, s, and so many messages it waits for: what goes on then has no end.
MOST_SEC = 4.5
MANY = 10
# A publisher that was silent so long, and for so many of its periods, begins anew.
PAUSE_SEC = 1.0
PAUSE_PERIODS = 3.0
# How far a rate may be off, as a part of it, and what two clocks may differ by: on a busy machine
# one of a few messages is late.
TOLERANCE, CLOCKS_DIFFER = 0.15, 0.005
# Gaps that differ by this factor are no longer even.
EVEN = 1.3

ELSEWHERE_TOO = WORDS.mistake('commands/elsewhere-too')
OTHER_TYPE = WORDS.mistake('commands/other-type')


@dataclass(frozen=True)
class Sent:
    """What has come on a topic.

    Attributes:
        recording: Where it came from.
        earlier: What the check before has kept.
        new: What has come since, in its order.
        is_running: Whether a command that sends it has not ended yet.
        goes_on: Whether messages came on and on while the check looked at it.
    """

    recording: Recording
    earlier: Samples
    new: Samples
    is_running: bool
    goes_on: bool

    @property
    def samples(self) -> list[Sample]:
        """All of it."""
        return [*self.earlier, *self.new]


@dataclass(frozen=True)
class OnTopic(Clause[Sent]):
    """Messages of a type are sent to a topic, and to no other one.

    Attributes:
        topic: Full name of the topic.
        msg_type: Name of the type.
    """

    topic: str
    msg_type: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return WORDS.of(topic=self.topic, msg_type=self.msg_type).clause('on-topic')

    @property
    def roles(self) -> dict[Role, str]:
        """Commands publish."""
        return {(PUBLISHER, self.topic): self.msg_type}


@dataclass(frozen=True)
class Commands(Stage[Sent]):
    """Commands of the learner's that send messages to a topic.

    Attributes:
        where: The first clause of the task.
        expected: What should have come, in words.
        says: What is said if all was right.
        is_whole: Whether nothing is missing.
        is_too_much: Whether it is clear already that it is not what was asked for.
        keep: Which messages count for the next check, if this is no PASS; all if not given.
    """

    where: OnTopic
    expected: str
    says: str
    is_whole: Callable[[Samples], bool]
    is_too_much: Callable[[Samples], bool]
    keep: Callable[[Sent], Samples] = lambda sent: sent.samples

    @contextmanager
    def scenes(self, probe: Probe, clauses: Sequence[Clause[Sent]]) -> Iterator[Sequence[Sent]]:
        """Wait for what commands send."""
        with naming(self.where):
            sent = self._sent(probe)
        try:
            yield [sent]
            with naming(self.where):
                self._refuse_other_topics(probe)
        except Fail:
            sent.recording.keep(self.keep(sent))
            # A command that was refused later explains why the messages are not all there.
            with naming(self.where):
                explain_last_command(self.where.topic, self.expected)
            forget_commands()
            raise
        forget_commands()

    def tell(self, seen: Sequence[Sent]) -> str:
        """Say that all was right."""
        return self.says

    def _sent(self, probe: Probe) -> Sent:
        """Wait as long as a command runs or messages keep coming; return what was sent."""
        from labkit.background.runtime import runtime

        topic = self.where.topic
        recording = probe.recorded[topic]
        assert isinstance(recording, Recording)
        started = time.monotonic()

        def samples() -> Samples:
            return [*recording.earlier, *recording.samples]

        def silent_sec() -> float:
            return time.monotonic() - max(started, recording.last_arrival)

        def is_there() -> bool:
            recording.pump()
            return bool(recording.samples or _commands(probe, topic) or probe.publishers(topic))

        def is_over() -> bool:
            recording.pump()
            if len(recording.samples) - count > MANY:
                return True
            if recording.samples and self.is_too_much(samples()):
                return True
            if _commands(probe, topic):
                return False
            whole = self.is_whole(samples()) or not probe.publishers(topic)
            longest = GONE_SEC if whole else SILENT_SEC
            # A timer of this notebook may be late.
            if silent_sec() <= longest or not runtime.executor.settle(longest):
                return False
            recording.pump()
            return silent_sec() > longest

        probe.wait_to_appear(is_there)
        count = len(recording.samples)
        in_time = probe.wait(is_over, MOST_SEC)
        self._refuse_other_type(probe)
        if not recording.samples:
            self._refuse_nothing(probe, recording.earlier)
        is_running = _commands(probe, topic)
        keeps_coming = not in_time and not is_running and silent_sec() < SILENT_SEC
        return Sent(
            recording,
            earlier=list(recording.earlier),
            new=list(recording.samples),
            is_running=is_running,
            goes_on=keeps_coming or len(recording.samples) - count > MANY,
        )

    def _refuse_other_topics(self, probe: Probe) -> None:
        """Raise Fail if messages of the type of the task are sent to another topic as well."""
        topic, msg_type = self.where.topic, self.where.msg_type
        found = [end.topic for end in self._elsewhere(probe)]
        other = found[0] if found else other_topic(topic, msg_type, probe.scope.known)
        if other:
            raise Fail(
                f'messages on {topic}, and on no other topic',
                f'what was asked for, and messages on {other} as well',
                ELSEWHERE_TOO.of(topic=topic, other=other),
            )

    def _elsewhere(self, probe: Probe) -> list[Endpoint]:
        """Return the learner's publishers of the type on topics that the lesson does not know."""
        return [
            end
            for end in probe.all_publishers()
            if end.msg_type == self.where.msg_type and end.topic not in probe.scope.known
        ]

    def _refuse_nothing(self, probe: Probe, earlier: Samples) -> NoReturn:
        """Raise what explains why nothing new has come."""
        topic = self.where.topic
        explain_last_command(topic, self.expected)
        if earlier:
            raise NotAttempted(f'Nothing new has come on {topic} since the last check.')
        for end in self._elsewhere(probe):
            raise Fail(
                self.expected,
                f'{end.node} publishes on {end.topic}',
                common_mistakes.OTHER_NAME.of(seen=end.topic, wanted=topic).then(
                    f'Write the topic as {topic}.'
                ),
            )
        if _commands(probe, topic) or probe.publishers(topic):
            raise NotAttempted(
                f'There is a publisher on {topic}, but nothing has come yet. Run this cell again '
                'when the command has ended.'
            )
        raise NotAttempted(
            f'Not attempted yet: nothing has come on {topic}. Write your commands in the cell '
            'above, run that cell, then run this one again. If a command says that something is '
            'wrong, nothing was sent.'
        )

    def _refuse_other_type(self, probe: Probe) -> None:
        """Raise Fail if a command, of a terminal perhaps, is there with another type."""
        topic, msg_type = self.where.topic, self.where.msg_type
        for info in probe.node.get_publishers_info_by_topic(topic):
            if info.topic_type != msg_type:
                raise Fail(
                    self.expected,
                    f'a publisher on {topic} with messages of type {info.topic_type}',
                    OTHER_TYPE.of(msg_type=msg_type),
                )


def newest_run(samples: Samples) -> list[Sample]:
    """Return the newest messages of the publisher that was heard last, without a long pause.

    A cell or a command may have been run before: each attempt is a run of its own.
    """
    runs: list[list[Sample]] = []
    for sample in samples:
        following = [run for run in runs if run[-1].number < sample.number]
        if following:
            # Of two that count alike, the later one goes on: the other has ended.
            following[-1].append(sample)
        else:
            runs.append([sample])
    newest = max(runs, key=lambda run: run[-1].stamp)
    gaps = [later.stamp - earlier.stamp for earlier, later in pairwise(newest)]
    pause = max(PAUSE_SEC, PAUSE_PERIODS * median(gaps)) if gaps else 0.0
    begins = [number for number, gap in enumerate(gaps, start=1) if gap > pause]
    return newest[begins[-1] if begins else 0 :]


def messages_at_once(samples: Samples, run: Samples) -> int:
    """Return how many messages of others came while a run did."""
    between = [s for s in samples if run[0].stamp <= s.stamp <= run[-1].stamp]
    return len(between) - len(run)


def is_every(period_sec: float, run: Samples, commanded_hz: float | None) -> bool:
    """Tell whether the messages of a run were to come with this time in between.

    Stamps tell it if they are even. A busy machine delays some messages, or skips calls of a
    timer. Then the command tells it, and if that is not known, as in another process, messages
    may come more slowly, as long as some are in time.

    Args:
        period_sec: The time, s.
        run: The messages.
        commanded_hz: The rate that the command was given, if it is known.
    """
    off = TOLERANCE + CLOCKS_DIFFER
    gaps = [later.stamp - earlier.stamp for earlier, later in pairwise(run)]
    seen = (mean(gaps), period(run))
    if max(gaps) < EVEN * min(gaps):
        return any(abs(period_sec / sec - 1.0) <= off for sec in seen)
    if commanded_hz is not None:
        return abs(period_sec * commanded_hz - 1.0) <= off
    return min(gaps) <= period_sec * (1.0 + off) and max(seen) >= period_sec * (1.0 - off)


def period(run: Samples) -> float:
    """Return the time from one message of a run to the next, in seconds."""
    return median(
        (later.stamp - earlier.stamp) / (later.number - earlier.number)
        for earlier, later in combinations(run, 2)
    )


def _commands(probe: Probe, topic: str) -> bool:
    """Tell whether a command of another process publishes: its node is hidden."""
    from labkit.rosgraph.endpoints import publishers
    from labkit.rosgraph.names import is_hidden

    return any(
        is_hidden(end.node) and not probe.in_this_process(end)
        for end in publishers(probe.node, topic)
    )
