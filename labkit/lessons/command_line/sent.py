"""What was sent to a topic: waited for until it is all there, attempt by attempt.

A message does not say who has sent it, but as which one: every publisher counts from 1.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from statistics import mean, median
from typing import TYPE_CHECKING, NoReturn

from labkit.exercises import Fail, NotAttempted, Probe
from labkit.exercises.clauses import Clause
from labkit.exercises.clauses.base import naming
from labkit.exercises.recorder import Recording
from labkit.exercises.watch import Sample
from labkit.lessons.command_line.last_command import (
    explain_last_command,
    forget_commands,
    other_topic,
)

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = [
    'Asked',
    'OnTopic',
    'Sent',
    'is_every',
    'judge_sent',
    'messages_at_once',
    'newest_run',
    'period',
]

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
# How far a rate may be off, as the task says, and what two clocks may differ by: on a busy machine
# one of a few messages is late.
TOLERANCE = 0.155
# Gaps that differ by this factor are no longer even.
EVEN = 1.3


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
class OnTopic(Clause):
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
        return f'on `{self.topic}` and no other topic, with the type `{self.msg_type}`'


@dataclass(frozen=True)
class Asked(Clause):
    """What else a task asks of the messages.

    Attributes:
        words: What is asked for, in words of the task.
        look: Raises Fail if the messages are otherwise, NotAttempted if it is too early to tell.
    """

    words: str
    look: Callable[[Sent], None]

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words


def judge_sent(
    probe: Probe,
    where: OnTopic,
    clauses: Sequence[Asked],
    expected: str,
    *,
    is_whole: Callable[[Samples], bool],
    is_too_much: Callable[[Samples], bool],
    keep: Callable[[Sent], Samples],
) -> None:
    """Wait for what commands send, and look at it clause by clause.

    Args:
        probe: The probe of the check.
        where: The first clause of the task.
        clauses: The others.
        expected: What should have come, in words.
        is_whole: Whether nothing is missing.
        is_too_much: Whether it is clear already that it is not what was asked for.
        keep: Which messages count for the next check, if this is no PASS.

    Raises:
        Fail: A clause is not fulfilled; the exception names it.
        NotAttempted: Nothing has come, or it is too early to tell.
    """
    with naming(where):
        sent = _sent_to(probe, where, expected, is_whole, is_too_much)
    try:
        for clause in clauses:
            with naming(clause):
                clause.look(sent)
        with naming(where):
            _refuse_other_topics(probe, where)
    except Fail:
        sent.recording.keep(keep(sent))
        # A command that was refused later explains why the messages are not all there.
        with naming(where):
            explain_last_command(where.topic, expected)
        forget_commands()
        raise
    forget_commands()


def _sent_to(
    probe: Probe,
    where: OnTopic,
    expected: str,
    is_whole: Callable[[Samples], bool],
    is_too_much: Callable[[Samples], bool],
) -> Sent:
    """Wait as long as a command runs or messages keep coming; return what was sent."""
    topic = where.topic
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
        if recording.samples and is_too_much(samples()):
            return True
        if _commands(probe, topic):
            return False
        if is_whole(samples()) or not probe.publishers(topic):
            return silent_sec() > GONE_SEC
        return silent_sec() > SILENT_SEC

    probe.wait_to_appear(is_there)
    count = len(recording.samples)
    in_time = probe.wait(is_over, MOST_SEC)
    _refuse_other_type(probe, where, expected)
    if not recording.samples:
        _refuse_nothing(probe, where, expected, recording.earlier)
    is_running = _commands(probe, topic)
    keeps_coming = not in_time and not is_running and silent_sec() < SILENT_SEC
    return Sent(
        recording,
        earlier=list(recording.earlier),
        new=list(recording.samples),
        is_running=is_running,
        goes_on=keeps_coming or len(recording.samples) - count > MANY,
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
    gaps = [later.stamp - earlier.stamp for earlier, later in pairwise(run)]
    seen = (mean(gaps), period(run))
    if max(gaps) < EVEN * min(gaps):
        return any(abs(period_sec / sec - 1.0) <= TOLERANCE for sec in seen)
    if commanded_hz is not None:
        return abs(period_sec * commanded_hz - 1.0) <= TOLERANCE
    return min(gaps) <= period_sec * (1.0 + TOLERANCE) and max(seen) >= period_sec * (
        1.0 - TOLERANCE
    )


def period(run: Samples) -> float:
    """Return the time from one message of a run to the next, in seconds."""
    return median(
        (later.stamp - earlier.stamp) / (later.number - earlier.number)
        for earlier, later in combinations(run, 2)
    )


def _refuse_other_topics(probe: Probe, where: OnTopic) -> None:
    """Raise Fail if messages of the type of the task are sent to another topic as well."""
    topic = where.topic
    found = [end.topic for end in _elsewhere(probe, where)]
    other = found[0] if found else other_topic(topic, where.msg_type, probe.scope.known)
    if other:
        raise Fail(
            f'messages on {topic}, and on no other topic',
            f'what was asked for, and messages on {other} as well',
            why=f'The task asks for {topic} only.',
            todo=f'End what publishes on {other}, and send the messages to {topic} once more.',
        )


def _elsewhere(probe: Probe, where: OnTopic) -> list[Endpoint]:
    """Return the learner's publishers of the type on topics that the lesson does not know."""
    return [
        end
        for end in probe.all_publishers()
        if end.msg_type == where.msg_type and end.topic not in probe.scope.known
    ]


def _refuse_nothing(probe: Probe, where: OnTopic, expected: str, earlier: Samples) -> NoReturn:
    """Raise what explains why nothing new has come."""
    topic = where.topic
    explain_last_command(topic, expected)
    if earlier:
        raise NotAttempted(f'Nothing new has come on {topic} since the last check.')
    for end in _elsewhere(probe, where):
        raise Fail(
            expected,
            f'{end.node} publishes on {end.topic}',
            why=f'{end.topic} is not {topic}: names must be equal to the last letter.',
            todo=f'Write the topic as {topic}.',
        )
    if _commands(probe, topic) or probe.publishers(topic):
        raise NotAttempted(
            f'Somebody is going to publish on {topic}, but nothing has come yet. Run this cell '
            'again when the command has ended.'
        )
    raise NotAttempted(
        f'Not attempted yet: nothing has come on {topic}. Write your commands in the cell above, '
        'run that cell, then run this one again. If a command says that something is wrong, '
        'nothing was sent.'
    )


def _refuse_other_type(probe: Probe, where: OnTopic, expected: str) -> None:
    """Raise Fail if a command, of a terminal perhaps, is there with another type."""
    for info in probe.node.get_publishers_info_by_topic(where.topic):
        if info.topic_type != where.msg_type:
            raise Fail(
                expected,
                f'a publisher on {where.topic} with messages of type {info.topic_type}',
                why='A topic carries one type of message. Nobody hears messages of another type.',
                todo=f'Stop that command with Ctrl-C, and use {where.msg_type}.',
            )


def _commands(probe: Probe, topic: str) -> bool:
    """Tell whether a command of another process publishes: its node is hidden."""
    from labkit.rosgraph.endpoints import publishers
    from labkit.rosgraph.names import is_hidden

    return any(
        is_hidden(end.node) and not probe.in_this_process(end)
        for end in publishers(probe.node, topic)
    )
