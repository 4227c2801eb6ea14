"""A clause on what is published: how often, and without an end."""

from __future__ import annotations

import statistics
import time
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, NoReturn

from labkit.exercises import common_mistakes
from labkit.exercises.clauses.base import Evidence, GraphClause, Stream
from labkit.exercises.expect import spinning, timing
from labkit.exercises.figures import figure, many
from labkit.exercises.history import history
from labkit.exercises.messages_heard import Lived, Sample, Watch, streams_of
from labkit.exercises.mistakes import Mistake
from labkit.exercises.observation import Life, live
from labkit.exercises.verdict import Fail, NotAttempted
from labkit.exercises.what_is_asked import PUBLISHER, Role
from labkit.exercises.words import words_of

if TYPE_CHECKING:
    from labkit.exercises.history import Note
    from labkit.exercises.probe import Probe
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['OFF', 'Publishes', 'in_words', 'often']

WORDS = words_of(__file__)

# How far a rate may be off, as a part of it, where time is virtual.
TOLERANCE = 0.02
# The same in words of a task.
OFF = WORDS.of(percent=f'{100 * TOLERANCE:.0f}').clause('off')
# How far a single gap may be off: a node may look at the clock in steps of its own, five in a
# period at least.
GAP_TOLERANCE = 0.2
# So many messages may come at once though a timer sends them: the first, and two that were late.
HELD_UP = 2
# So many calls of a timer may pass until it has made its publisher.
FIRST_CALLS = 3
# What was seen, and what is wrong with it.
Trouble = tuple[str, Mistake]
# Numbers that have a word, and those that have one as often as something is done.
_NUMBERS = ('3', '4', '5', '8', '10', '20')
_TIMES: dict[float, str] = {1: 'once', 2: 'twice'}


def in_words(number: float) -> str:
    """Return a number as a word of a task: `'ten'`; a larger one in digits."""
    text = figure(number)
    return WORDS.clause(text) if text in _NUMBERS else text


def often(hz: float) -> str:
    """Return a rate in words: `'ten times a second (10 Hz, up to 2 % off)'`."""
    if hz < 1:
        return WORDS.of(period=figure(1 / hz), off=OFF).clause('every')
    told = WORDS.of(hz=figure(hz), number=in_words(hz), off=OFF)
    return told.clause(_TIMES.get(hz, 'often'))


@dataclass(frozen=True)
class Publishes(GraphClause):
    """A node publishes on a topic at a rate, and goes on.

    Attributes:
        topic: Full name of the topic.
        hz: Messages a second.
        msg_type: Name of the type.
        by: Full name of the node; any node if empty.
        at_least: Whether more are right, too.
        ends: Whether it may end. What it publishes until then comes at that rate.
        from_start: Whether it has had this rate since it was made.
    """

    topic: str
    hz: float
    msg_type: str
    by: str = ''
    at_least: bool = False
    ends: bool = False
    from_start: bool = True

    @property
    def period(self) -> float:  # type: ignore[override]
        """Seconds from one message to the next."""
        return 1.0 / self.hz

    @property
    def text(self) -> str:
        """What is asked for."""
        rate = often(self.hz)
        if self.at_least:
            rate = WORDS.of(rate=rate.partition(' (')[0]).clause('at-least')
        if not self.ends:
            rate = WORDS.of(rate=rate).clause('without-end')
        told = WORDS.of(
            node=self.by.lstrip('/'), msg_type=self.msg_type, topic=self.topic, rate=rate
        )
        return told.clause('node-publishes' if self.by else 'publishes')

    @property
    def roles(self) -> dict[Role, str]:
        """It publishes."""
        return {(PUBLISHER, self.topic): self.msg_type}

    @property
    def listens(self) -> Collection[str]:
        """Where it publishes."""
        return (self.topic,)

    def find(self, evidence: Evidence) -> None:
        """Look for the publisher. One that is made in a callback may not be there yet."""
        probe = evidence.probe
        if not probe.publishers(self.topic):
            silent = set(probe.node_names()) - {end.node for end in probe.all_publishers()}
            nodes = [name for name in sorted(silent) if probe.node_object(name) is not None]
            if nodes:
                evidence.life = live(probe, {}, FIRST_CALLS * self.period, nodes=nodes)
                evidence.refuse_trouble(())
        evidence.publisher(self.topic, self.by)

    def judge(self, evidence: Evidence) -> str:
        """Judge the rate, and whether it goes on."""
        source = evidence.publisher(self.topic, self.by)
        if self.by and self.topic not in evidence.probe.scope.sole:
            stream = self._one_of_several(evidence, source)
        else:
            stream = self._stream(evidence, source, evidence.life.on(self.topic))
        stream = replace(stream, earlier=evidence.earlier(self.topic, source.node))
        evidence.streams[self.topic, self.by] = stream
        self._refuse_burst(stream.earlier)
        if stream.exact:
            rate, seconds = 1 / max(_period(stream.samples), 1e-9), stream.seconds
            return (
                f'{source.node} publishes {figure(rate)} Hz on {self.topic}, {seconds:.0f} s long.'
            )
        return (
            f'{source.node} publishes about {figure(self.hz)} Hz on {self.topic}. It keeps a time '
            f'of its own, so the check has watched it for {stream.seconds:.1f} s. What it does '
            'later was not seen.'
        )

    def _one_of_several(self, evidence: Evidence, source: Endpoint) -> Stream:
        """Return the messages of one of the nodes that publish on the topic.

        Of a node of another process nobody knows which ones it has sent, but each publisher
        counts its own ones.
        """
        probe, topic = evidence.probe, self.topic
        said = evidence.life.on(topic)
        # Who keeps the method `publish` itself, as `partial` does, is not known either.
        if probe.in_this_process(source) and all(sample.node for sample in said):
            mine = [sample for sample in said if sample.node == self.by]
            self._refuse_two(replace(evidence.life, samples={topic: mine}))
            return self._stream(evidence, source, mine)
        nodes = sorted(by for kind, t, by in evidence.ends if (kind, t) == ('publisher', topic))
        found = self._right(evidence.life)
        owners = sorted(end.node for end in probe.publishers(topic) if end.node in nodes)
        if len(found) == len(nodes) and owners == nodes:
            # One for each, whoever is who.
            return found[nodes.index(self.by)]
        if not found and not evidence.life.real:
            for samples in self._by_publisher(evidence.life):
                trouble = self._trouble(samples, evidence.life)
                # A timer of another process that is due twice in a step seems to be slow: one
                # message a step.
                gaps, step = _gaps(samples), evidence.life.step
                known = (
                    source.node not in evidence.life.remote
                    or self._follows(source.node, samples, evidence.life)
                    or min(gaps, default=0.0) > 2 * step
                )
                if known and trouble and _is_even(gaps, step):
                    self._refuse(trouble)
        alone = evidence.alone(self, (), self.by)
        own = self._refuse_two(alone.life)
        if not own:
            # Of the others, whose time was real, little has come meanwhile.
            most = max(self._by_publisher(alone.life), key=len, default=[])
            return self._stream(alone, source, most, nodes)
        others = [(topic, node) for node in nodes if node != self.by]
        known = not evidence.life.real and all(key in evidence.streams for key in others)
        if len(found) < len(nodes) and known:
            # A thread speaks whichever node is alone, so one may have been taken for another.
            self._refuse_one_of(nodes, len(found))
        return own[0]

    def _refuse_two(self, life: Life) -> list[Stream]:
        """Return the messages of the publisher of the node, if there is one with the rate."""
        own = self._right(life)
        if len(own) > 1:
            raise Fail(
                f'one publisher of {self.by} on {self.topic}',
                f'{len(own)} publishers of {self.by} there, each with this rate',
                common_mistakes.SAID_BY_TWO,
            )
        return own

    def _stream(
        self,
        evidence: Evidence,
        source: Endpoint,
        samples: Sequence[Lived],
        nodes: Sequence[str] = (),
    ) -> Stream:
        """Return messages that come as they should, of a process that sleeps in real time.

        Args:
            evidence: What was seen.
            source: The publisher.
            samples: Its messages in virtual time.
            nodes: The nodes that publish on the topic, if there may be several.
        """
        probe, life = evidence.probe, evidence.life
        trouble = self._trouble(samples, life)
        if trouble is not None and probe.in_this_process(source):
            trouble = self._trouble(self._in_time(evidence, source.node, samples), life)
            trouble = self._without_advice_taken(probe, source.node, trouble)
        if trouble is None:
            return Stream(self.topic, tuple(samples), True, life.seconds)
        if probe.in_this_process(source):
            if len(samples) < 2:
                spinning.hanging()
                silence = timing.silence(probe, source, len(samples), life.seconds)
                raise Fail(self._expected(), trouble[0], silence)
            self._refuse(trouble)
        if evidence.has_ended_early():
            raise NotAttempted
        # One that was lost on the way did follow. What it does in real time says nothing of later.
        if source.node in life.lost or self._follows(source.node, samples, life):
            self._refuse(trouble)
        young = source.node not in life.remote and probe.something_is_starting()
        began, count = time.monotonic(), max(len(nodes), 1)
        right, watch = timing.at_rate(
            probe, source, self.hz, count=count, at_least=self.at_least, ends=self.ends
        )
        seconds = time.monotonic() - began
        if len(right) >= count:
            if not self.ends:
                self._refuse_ended(right, watch)
            real = [sample for stream in right for sample in stream]
            return Stream(self.topic, tuple(real), False, seconds)
        if young and not samples and not len(watch):
            # The graph may know a process before that process knows who listens.
            raise NotAttempted(
                f'Nothing has come on {self.topic} yet, from a process that was started a moment '
                'ago. Run this cell again.'
            )
        if len(nodes) > 1:
            self._refuse_one_of(nodes, len(right))
        if not samples and not len(watch):
            seen = f'no message in {seconds:.1f} s'
            raise Fail(self._expected(), seen, common_mistakes.NEVER_PUBLISHED)
        if watch.intervals and not _is_even(_gaps(samples), life.step):
            trouble = self._off(1 / max(statistics.median(watch.intervals), 1e-9))
        self._refuse(trouble)

    def _refuse_ended(self, right: Sequence[Sequence[Sample]], watch: Watch) -> None:
        """Raise if publishers in real time have ended, or have not shown yet that they go on."""
        short = [stream for stream in right if not timing.lasts(stream, self.hz)]
        if not short:
            return
        sent, silent = short[0][-1].number, time.monotonic() - watch.last_arrival
        if silent > timing.PAUSE_PERIODS * self.period:
            seen = f'{many(sent, "message")}, and then none for {silent:.1f} s'
            self._refuse((seen, common_mistakes.STOPS))
        raise NotAttempted(
            f'Too early to tell: the check has counted {many(sent, "message")} on {self.topic}, '
            'and waits for more, to see that they go on. Run this cell again.'
        )

    def _without_advice_taken(
        self, probe: Probe, name: str, trouble: Trouble | None
    ) -> Trouble | None:
        """Return what is wrong, with another reason if a timer has the right period already."""
        node = probe.node_object(name)
        if trouble is None or node is None:
            return trouble
        seen, mistake = trouble
        periods = [timer.timer_period_ns * 1e-9 for timer in node.timers]
        right = any(abs(period - self.period) < 1e-6 for period in periods)
        if right and mistake.id in (common_mistakes.OTHER_RATE.id, common_mistakes.TOO_FEW.id):
            return seen, common_mistakes.RIGHT_PERIOD.of(node=name)
        return trouble

    def _refuse_burst(self, earlier: Sequence[Note]) -> None:
        """Raise Fail if a node has begun with more messages than it has had time for.

        In real time, which these were published in, a timer or a sleep may last longer and is
        never shorter: a call that was held up is followed by one at once, and one in its time.
        What looks at a clock makes up for what it has missed since its node was made: a callback
        or a thread does, and not a line of `__init__`.
        """
        if self.at_least or not self.from_start:
            return
        for count, note in enumerate(earlier):
            seconds = note.at - earlier[0].at + (0.0 if note.in_making else earlier[0].owner_age)
            if count > (1 + TOLERANCE) * seconds * self.hz + HELD_UP:
                self._refuse(
                    (
                        f'{many(count + 1, "message")} in its first {figure(seconds)} s',
                        common_mistakes.BURSTS,
                    )
                )

    def _in_time(self, evidence: Evidence, node: str, samples: Sequence[Lived]) -> Sequence[Lived]:
        """Leave out messages that come at once at the beginning because they were due before.

        On a busy machine a thread may get its turn late, and one that looks at a clock makes up.
        """
        found = evidence.probe.node_object(node)
        notes = [each for each in history.on(self.topic) or () if each.is_by(found)]
        before = sum(note.began < evidence.life.began for note in notes)
        if not samples or before == len(notes):
            return samples
        # How long ago the node was made when time began to pass.
        age = notes[0].owner_age + (
            notes[before].at - notes[0].at - samples[0].at
            if before
            else 1e-9 * (evidence.life.began - notes[0].began)
        )
        late = 0
        for sample, following in pairwise(samples):
            due = (age + sample.at) * self.hz
            gap = following.at - sample.at
            if before + late >= due or gap > (1 - GAP_TOLERANCE) * self.period:
                break
            late += 1
        return samples[late:]

    def _right(self, life: Life) -> list[Stream]:
        """Return the messages of each publisher that does what the clause asks for."""
        return [
            Stream(self.topic, tuple(samples), True, life.seconds)
            for samples in self._by_publisher(life)
            if self._trouble(samples, life) is None
        ]

    def _by_publisher(self, life: Life) -> list[list[Lived]]:
        """Return the messages of each publisher.

        They are told apart by their numbers, so those that came just before have to be known.
        """
        found = streams_of(life.on(self.topic, before=True))
        lived = [[sample for sample in stream if sample.at >= 0] for stream in found]
        return [stream for stream in lived if stream]

    def _follows(self, node: str, samples: Sequence[Lived], life: Life) -> bool:
        """Tell whether a node of another process follows virtual time, and is right in part.

        A timer that is due more than once within a step seems to be slower than it is, always.
        """
        gaps = _gaps(samples)
        right = [gap for gap in gaps if abs(gap - self.period) < life.step + 1e-9]
        return node in life.remote and len(gaps) > 3 * FIRST_CALLS and len(right) > len(gaps) / 3

    def _trouble(self, samples: Sequence[Lived], life: Life) -> Trouble | None:
        """Return what was seen and why, if it is not what the clause asks for."""
        period, count = self.period, len(samples)
        if count < 2:
            seen = f'{"one message" if count else "no message"} in {life.seconds:.0f} s'
            return seen, common_mistakes.TOO_FEW.of(period=period)
        gaps, usual = _gaps(samples), _period(samples)
        longest, shortest, late = max(gaps), min(gaps), life.seconds - samples[-1].at
        if late > (1 + GAP_TOLERANCE) * max(period, longest) + life.step and not self.ends:
            return (
                f'{many(count, "message")}, the last one after {samples[-1].at:.1f} s, and then '
                f'none until {life.seconds:.0f} s',
                common_mistakes.STOPS,
            )
        bursts = (
            f'{many(count, "message")} in {life.seconds:.0f} s, with {figure(shortest)} s to '
            f'{figure(longest)} s in between',
            common_mistakes.BURSTS,
        )
        if longest > 3 * usual and not self.at_least:
            return bursts
        # Times of other processes are known to a step.
        margin = TOLERANCE + life.step / max(sum(gaps), period)
        rate = period / usual if usual else float('inf')
        if rate < 1 - margin or (rate > 1 + margin and not self.at_least):
            seen, mistake = self._off(rate * self.hz)
            outlasts = spinning.outlasts(life.overrun) if rate < 1 else None
            besides = self._besides(samples, life) if rate > 1 else None
            return besides or (seen, outlasts or mistake)
        if longest > (1 + GAP_TOLERANCE) * period + life.step + 1e-9 or (
            shortest < (1 - GAP_TOLERANCE) * period - life.step - 1e-9 and not self.at_least
        ):
            return bursts
        return None

    def _besides(self, samples: Sequence[Lived], life: Life) -> Trouble | None:
        """Return that a few messages differ from all others, which come as they should."""
        texts = [repr(sample.message) for sample in samples]
        usual, count = Counter(texts).most_common(1)[0]
        others = len(texts) - count
        # Without their numbers, by which the others would be counted, too.
        alike = [
            replace(sample, number=0)
            for sample, text in zip(samples, texts, strict=True)
            if text == usual
        ]
        if not 0 < others <= count / 2 or self._trouble(alike, life) is not None:
            return None
        seen = f'{many(len(texts), "message")}, {others} of them with another value'
        return seen, common_mistakes.ANOTHER_SOURCE.of(topic=self.topic)

    def _off(self, rate: float) -> Trouble:
        period = 1 / rate
        if not period:
            return 'all messages at one moment', common_mistakes.BURSTS
        factor = period * self.hz
        off = (
            f'{figure(factor)} times too slow'
            if factor > 1
            else f'{figure(1 / factor)} times too fast'
        )
        mistake = common_mistakes.OTHER_RATE
        if abs(period / self.hz - 1.0) < 0.02 and abs(self.hz - self.period) > 0.3 * self.hz:
            mistake = common_mistakes.RATE_FOR_PERIOD
        elif abs(factor - 0.5) < 0.02:
            mistake = common_mistakes.TWICE_AS_MANY
        seen = f'a message every {figure(period)} s ({figure(rate)} Hz): {off}'
        return seen, mistake.of(period=self.period)

    def _expected(self) -> str:
        least = 'at least ' if self.at_least else ''
        period, hz = figure(self.period), figure(self.hz)
        return f'{least}a message every {period} s ({hz} Hz) on {self.topic}'

    def _refuse(self, trouble: Trouble) -> NoReturn:
        raise Fail(self._expected(), *trouble)

    def _refuse_one_of(self, nodes: Sequence[str], count: int) -> NoReturn:
        """Refuse nodes of which too few publish: it may be any of them."""
        raise Fail(
            f'{self._expected()} of {self.by}',
            f'{count} of {len(nodes)} publishers with this rate',
            common_mistakes.ONE_OF_THESE.of(nodes=', '.join(nodes)),
        )


def _period(samples: Sequence[Sample]) -> float:
    """Return the mean time from one message to the next, s; 0 if there are too few.

    Messages are numbered by their publisher, so one that was lost on the way does no harm.
    """
    lived = [sample for sample in samples if isinstance(sample, Lived)]
    if len(lived) < 2:
        return 0.0
    first, last = lived[0], lived[-1]
    count = last.number - first.number if first.number else len(lived) - 1
    return (last.at - first.at) / max(count, len(lived) - 1)


def _gaps(samples: Sequence[Lived]) -> list[float]:
    """Return the seconds of virtual time from one message to the next."""
    return [later.at - earlier.at for earlier, later in pairwise(samples)]


def _is_even(gaps: Sequence[float], step: float) -> bool:
    """Tell whether messages come as evenly as only a timer of ROS makes them."""
    return len(gaps) >= 4 and max(gaps) - min(gaps) < step + 1e-6
