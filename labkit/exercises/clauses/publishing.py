"""A clause on what is published: how often, and without an end."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NoReturn

from labkit.exercises.clauses.base import Clause, Evidence, Stream
from labkit.exercises.expect import spinning, timing
from labkit.exercises.life import LIFE_SEC, Life, live
from labkit.exercises.verdict import Fail, NotAttempted
from labkit.exercises.watch import Lived, streams_of

if TYPE_CHECKING:
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['Publishes', 'often']

# How far a rate may be off, as a part of it, where time is exact. Where a node keeps a time of its
# own, `timing.TOLERANCE` holds.
TOLERANCE = 0.02
# How far a single gap may be off: a node may look at the clock in steps of its own.
GAP_TOLERANCE = 0.5
# So many calls of a timer may pass until it has made its publisher.
FIRST_CALLS = 3
# Gaps that differ by less than this are equal, s: that is what a timer of ROS makes.
REGULAR_SEC = 1e-6
# So much a rate in real time may differ from that in virtual time if both are one.
SAME_RATE = 0.3
# So much smaller are the steps of time if it matters.
FINER = 3
STOPS = 'They stop coming.'
BURSTS = 'They come in bursts, or with pauses.'
_WORDS: dict[float, str] = {
    1: 'once',
    2: 'twice',
    3: 'three times',
    4: 'four times',
    5: 'five times',
    8: 'eight times',
    10: 'ten times',
    20: 'twenty times',
}


def often(hz: float) -> str:
    """Return a rate in words: `'ten times a second (10 Hz, up to 2 % off)'`."""
    off = f'up to {100 * TOLERANCE:.0f} % off'
    if hz < 1:
        return f'every {1 / hz:g} seconds ({off})'
    return f'{_WORDS.get(hz, f"{hz:g} times")} a second ({hz:g} Hz, {off})'


@dataclass(frozen=True)
class Publishes(Clause):
    """A node publishes on a topic at a rate, and goes on.

    Attributes:
        topic: Full name of the topic. Its type is in the `publishes` of the exercise.
        hz: Messages a second.
        msg_type: Name of the type, for the words of the task.
        by: Full name of the node; any node if empty.
        at_least: Whether more are right, too.
        ends: Whether it may end. What it publishes until then comes at that rate.
    """

    topic: str
    hz: float
    msg_type: str
    by: str = ''
    at_least: bool = False
    ends: bool = False

    @property
    def period(self) -> float:  # type: ignore[override]
        """Seconds from one message to the next."""
        return 1.0 / self.hz

    @property
    def text(self) -> str:
        """What is asked for."""
        who = f'`{self.by.lstrip("/")}` publishes' if self.by else 'publish'
        rate = often(self.hz)
        if self.at_least:
            rate = f'at least {rate.partition(" (")[0]}'
        end = '' if self.ends else ', without end'
        return f'{who} `{self.msg_type}` on `{self.topic}`, {rate}{end}'

    def find(self, evidence: Evidence) -> None:
        """Look for the publisher. One that is made in a callback may not be there yet."""
        if not evidence.probe.publishers(self.topic):
            self._let_it_be_made(evidence)
        evidence.publisher(self.topic, self.by)

    def _let_it_be_made(self, evidence: Evidence) -> None:
        """Let some time pass for nodes of this notebook that do not publish at all yet."""
        probe = evidence.probe
        silent = set(probe.node_names()) - {end.node for end in probe.all_publishers()}
        nodes = [name for name in sorted(silent) if probe.node_object(name) is not None]
        if nodes:
            evidence.life = live(probe, {}, FIRST_CALLS * self.period, nodes=nodes)
            evidence.refuse_trouble(())

    def judge(self, evidence: Evidence) -> str:
        """Judge the rate, and whether it goes on."""
        source = evidence.publisher(self.topic, self.by)
        if self._is_one_of_several(evidence):
            return self._judge_one_of_several(evidence)
        life = evidence.life
        samples = life.on(self.topic)
        trouble = self._trouble(samples, life)
        hurried = trouble is not None and self._was_hurried(samples, life)
        if trouble is not None and life.remote and not hurried and _follows(samples, life):
            # A timer that is due more than once within a step of time is called once only.
            first, period = trouble, _period(_fine(samples, life))
            life = self._finer_life(evidence)
            samples = life.on(self.topic)
            trouble = self._trouble(samples, life)
            hurried = trouble is not None and self._was_hurried(samples, life)
            quicker = 0 < _period(_fine(samples, life)) < 0.8 * period
            if trouble is not None and not hurried and not quicker:
                self._refuse(first)
        elif trouble is not None and not hurried and self._follows_ros_time(samples, life):
            self._refuse(trouble)
        if trouble is not None:
            watch = self._in_real_time(evidence, trouble, samples, hurried=hurried)
            stream = Stream(self.topic, tuple(watch.samples), False, 0.0)
        else:
            stream = Stream(self.topic, tuple(samples), True, life.seconds)
        evidence.streams[self.topic, self.by] = stream
        if not stream.exact:
            return f'{source.node} publishes {timing.describe_rate(watch)} on {self.topic}.'
        return self._say(source, stream, life)

    def _finer_life(self, evidence: Evidence) -> Life:
        """Let time pass once more, in smaller steps."""
        topics = {self.topic: evidence.probe.scope.publishes[self.topic]}
        return evidence.live(topics, LIFE_SEC, [replace(self, hz=FINER * self.hz)])

    def _say(self, source: Endpoint, stream: Stream, life: Life) -> str:
        lived = [sample for sample in stream.samples if isinstance(sample, Lived)]
        rate, seconds = _rate(_fine(lived, life)), stream.seconds
        return f'{source.node} publishes {rate:.3g} Hz on {self.topic}, {seconds:.0f} s long.'

    # -- several publishers on one topic --------------------------------------------------------

    def _is_one_of_several(self, evidence: Evidence) -> bool:
        return bool(self.by) and self.topic not in evidence.probe.scope.sole

    def _judge_one_of_several(self, evidence: Evidence) -> str:
        """Judge a publisher of a topic that has several.

        A message does not say who has sent it, but each publisher counts its own ones.
        """
        nodes = self._nodes(evidence)
        found = self._right(evidence.life)
        owners = [end.node for end in evidence.probe.publishers(self.topic) if end.node in nodes]
        if len(found) == len(nodes) and sorted(owners) == nodes:
            # One for each, whoever is who.
            stream = found[nodes.index(self.by)]
        else:
            if not found:
                self._refuse_many(evidence.life)
            stream = self._alone(evidence) or self._among_others(evidence)
        evidence.streams[self.topic, self.by] = stream
        if not stream.exact:
            return f'{self.by} publishes about {self.hz:.3g} Hz on {self.topic}.'
        return self._say(evidence.publisher(self.topic, self.by), stream, evidence.life)

    def _nodes(self, evidence: Evidence) -> list[str]:
        """Return the nodes that clauses ask for on the topic."""
        ends = [(by, topic) for kind, topic, by in evidence.ends if kind == 'publisher']
        return sorted(by for by, topic in ends if topic == self.topic)

    def _follows_ros_time(self, samples: Sequence[Lived], life: Life) -> bool:
        """Tell whether messages follow ROS time: a thread makes few of them in so short a time."""
        return _is_regular(samples) or len(samples) > self.hz * life.seconds / 2

    def _right(self, life: Life) -> list[Stream]:
        """Return the messages of each publisher that does what the clause asks for."""
        return [
            Stream(self.topic, tuple(samples), True, life.seconds)
            for samples in streams_of(life.on(self.topic))
            if self._trouble(samples, life) is None
        ]

    def _alone(self, evidence: Evidence) -> Stream | None:
        """Return what came while time passed for this node alone.

        None if it is not right, but few messages: they may be of a thread, or another node's.

        Raises:
            Fail: It is not right.
        """
        life = evidence.alone(self, (), self.by).life
        found = self._right(life)
        if not found:
            self._refuse_many(life)
        if len(found) > 1:
            raise Fail(
                f'one publisher of {self.by} on {self.topic}',
                f'{len(found)} publishers of {self.by} there, each with this rate',
                why='Each thing is said by two publishers, so it is said twice.',
                todo='Make one publisher, in __init__, and keep it.',
            )
        return found[0] if found else None

    def _refuse_many(self, life: Life) -> None:
        """Raise Fail if there are so many messages that they follow ROS time, but wrongly."""
        for samples in streams_of(life.on(self.topic)):
            trouble = self._trouble(samples, life)
            if trouble and self._follows_ros_time(samples, life):
                self._refuse(trouble)

    def _among_others(self, evidence: Evidence) -> Stream:
        """Return the messages of all in real time, if there is one publisher for each node.

        Raises:
            Fail: There are fewer.
        """
        probe, topic, nodes = evidence.probe, self.topic, self._nodes(evidence)
        source = evidence.publisher(topic, self.by)
        found = timing.at_rate(probe, topic, source.msg_type, self.hz, count=len(nodes))
        if len(found) >= len(nodes):
            samples = [sample for stream in found for sample in stream]
            return Stream(topic, tuple(samples), False, 0.0)
        spinning.hanging()
        why, todo = timing.reason(probe, source)
        # Those that follow ROS time are known. If somebody else talks, it may be this one.
        if len(found) > len(self._right(evidence.life)):
            why = f'One of these nodes does not publish at this rate: {", ".join(nodes)}.'
            todo = 'Compare what they do, line by line.'
        raise Fail(
            f'a message every {self.period:.3g} s ({self.hz:.3g} Hz) of {self.by} on {topic}',
            f'{len(found)} of {len(nodes)} publishers with this rate',
            why=why,
            todo=todo,
        )

    # -- a node that keeps a time of its own ----------------------------------------------------

    def _was_hurried(self, samples: Sequence[Lived], life: Life) -> bool:
        """Tell whether a rate was right until time passed in large steps, on a slow machine.

        Then a timer that counts its calls seems to publish more and more slowly.
        """
        if not life.remote or life.rest <= max(self.period, 0.1):
            return False
        before = replace(life, seconds=min(life.seconds, life.fine_sec))
        return self._trouble(_fine(samples, life), before) is None

    def _in_real_time(
        self, evidence: Evidence, trouble: tuple[str, str], samples: Any, *, hurried: bool
    ) -> Any:
        """Watch in real time: the node may keep a time of its own, such as a sleeping thread.

        Args:
            evidence: What was seen.
            trouble: What is wrong in virtual time.
            samples: The messages of virtual time.
            hurried: Whether that may be due to large steps of time.

        Raises:
            Fail: It does not.
            NotAttempted: Nothing has come, and its process is young.
        """
        probe, source = evidence.probe, evidence.publisher(self.topic, self.by)
        if evidence.has_ended_early():
            raise NotAttempted
        # The graph may know a process before that process knows who listens.
        young = not probe.in_this_process(source) and source.node not in evidence.life.remote
        young = young and probe.something_is_starting()
        try:
            watch = timing.messages(probe, source, count=3, hz=self.hz, at_least=self.at_least)
        except Fail as fail:
            # What was seen exactly is the better reason, if it is about the same messages.
            if len(samples) > 2 and trouble[0]:
                self._refuse(trouble)
            if young and not samples and 'no message' in fail.seen:
                raise NotAttempted(
                    f'Nothing has come on {self.topic} yet, from a process that was started a '
                    'moment ago. Run this cell again.'
                ) from None
            raise
        real, seen = statistics.median(watch.intervals), _period(samples)
        if seen and not hurried and abs(seen / real - 1.0) < SAME_RATE:
            self._refuse(trouble)
        return watch

    def _trouble(self, samples: Sequence[Lived], life: Life) -> tuple[str, str] | None:
        """Return what was seen and why, if it is not what the clause asks for."""
        if len(samples) < 2:
            count = len(samples)
            seen = f'{"one message" if count else "no message"} in {life.seconds:.0f} s'
            return seen, 'The messages come much too slowly, or have stopped coming.'
        # Times of other processes are known to a tick, and later on less well.
        tick, rest = (life.tick, life.rest) if life.remote else (0.0, 0.0)
        fine = _fine(samples, life)
        rate, period = _rate(fine), self.period
        gaps, fine_gaps = _gaps(samples), _gaps(fine)
        late = life.seconds - samples[-1].at
        if late > (1 + GAP_TOLERANCE) * max(period, *gaps) + max(tick, rest) and not self.ends:
            return (
                f'{len(samples)} messages, the last one after {samples[-1].at:.1f} s, and then '
                f'none until {life.seconds:.0f} s',
                STOPS,
            )
        longest, shortest = max(gaps), min(fine_gaps)
        bursts = (
            f'{len(samples)} messages in {life.seconds:.0f} s, with {shortest:.3g} s to '
            f'{longest:.3g} s in between',
            BURSTS,
        )
        if max(fine_gaps) > 3 / rate and not self.at_least:
            return bursts
        margin = TOLERANCE + tick / max(sum(fine_gaps), period)
        too_fast = rate * period > 1 + margin and not self.at_least
        if too_fast or rate * period < 1 - margin:
            return self._off(rate)
        if longest > (1 + GAP_TOLERANCE) * period + max(tick, rest) + 1e-9 or (
            shortest < (1 - GAP_TOLERANCE) * period - tick - 1e-9 and not self.at_least
        ):
            return bursts
        return None

    def _off(self, rate: float) -> tuple[str, str]:
        period = 1 / rate
        if not period:
            return 'all messages at one moment', BURSTS
        factor = period * self.hz
        off = f'{factor:.3g} times too slow' if factor > 1 else f'{1 / factor:.3g} times too fast'
        why = 'The rate is set by the period of the timer, or by the time the loop sleeps.'
        if abs(period / self.hz - 1.0) < 0.02 and abs(self.hz - self.period) > 0.3 * self.hz:
            why = 'A rate in Hz and a period in seconds were mixed up: the period is 1 / rate.'
        elif abs(factor - 0.5) < 0.02:
            why = (
                'Twice as many messages come as were asked for: is publish() called twice, or '
                'is the period half as long?'
            )
        return f'a message every {period:.3g} s ({rate:.3g} Hz): {off}', why

    def _refuse(self, trouble: tuple[str, str]) -> NoReturn:
        least = 'at least ' if self.at_least else ''
        todo = f'The first argument of create_timer() is the period in seconds: {self.period:.3g}'
        if trouble[1] in (STOPS, BURSTS):
            todo = 'Publish once in each call of a timer with this period, and let it go on.'
        raise Fail(
            f'{least}a message every {self.period:.3g} s ({self.hz:.3g} Hz) on {self.topic}',
            trouble[0],
            why=trouble[1],
            todo=todo,
        )


def _rate(samples: Sequence[Lived]) -> float:
    """Return the messages a second."""
    period = _period(samples)
    return 1 / period if period else float('inf')


def _period(samples: Sequence[Lived]) -> float:
    """Return the mean time from one message to the next, s; 0 if there are too few.

    Messages are numbered by their publisher, so one that was lost on the way does no harm.
    """
    if len(samples) < 2:
        return 0.0
    first, last = samples[0], samples[-1]
    count = last.number - first.number if first.number else len(samples) - 1
    return (last.at - first.at) / max(count, len(samples) - 1)


def _fine(samples: Sequence[Lived], life: Life) -> Sequence[Lived]:
    """Return the messages that tell the rate best; see `Life.fine_sec`."""
    fine = [sample for sample in samples if not life.remote or sample.at <= life.fine_sec]
    return fine if len(fine) > 2 else samples


def _gaps(samples: Sequence[Lived]) -> list[float]:
    """Return the seconds of virtual time from one message to the next."""
    return [later.at - earlier.at for earlier, later in pairwise(samples)]


def _follows(samples: Sequence[Lived], life: Life) -> bool:
    """Tell whether messages of another process come as evenly as its steps of time let them."""
    gaps, step = _gaps(samples), max(life.tick, life.rest)
    even = len(gaps) >= 4 and max(gaps) - min(gaps) < step + REGULAR_SEC and min(gaps) > step
    return even or _is_regular(_fine(samples, life))


def _is_regular(samples: Sequence[Lived]) -> bool:
    """Tell whether messages come as evenly in virtual time as only a timer of ROS can."""
    gaps = _gaps(samples)
    return len(gaps) >= 4 and max(gaps) - min(gaps) < REGULAR_SEC
