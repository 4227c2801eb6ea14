"""Clauses on quality of service: who matches whom, and what is kept for who comes later."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from labkit.exercises import common_mistakes, expect
from labkit.exercises.callback_count import is_given
from labkit.exercises.clauses.base import Evidence, GraphClause
from labkit.exercises.expect.values import show
from labkit.exercises.figures import figure, many
from labkit.exercises.verdict import Fail, NotAttempted

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['Latched', 'Matches']

# How long what was kept may take to arrive from another process, s.
KEPT_SEC = 5.0
# A policy that lasts longer than this has no end, s.
FOR_EVER_SEC = 1e9


@dataclass(frozen=True, eq=False)
class Matches(GraphClause):
    """The learner's end of a topic matches the end of a node that the lesson gives.

    Attributes:
        topic: Full name of the topic.
        node: Full name of the given node. It is in `given` of the lesson, too.
        words: What is asked for, in words of the task.
        start: What the learner does if that node is not there.
        subscribes: Whether it is the given node that subscribes; else it publishes.
        is_as_given: Tells whether the profile of the given end is what the lesson has made it.
    """

    topic: str
    node: str
    words: str
    start: str
    subscribes: bool = False
    is_as_given: Callable[[Any], bool] = lambda profile: True

    def find(self, evidence: Evidence) -> None:
        """Compare the two ends, as the graph knows them."""
        mine = (
            evidence.publisher(self.topic)
            if self.subscribes
            else evidence.subscription(self.topic)
        )
        given = self._given(evidence)
        if not given:
            raise NotAttempted(f'There is no node {self.node} of the lesson. {self.start}')
        pair = (mine, given[0]) if self.subscribes else (given[0], mine)
        try:
            self._refuse_apart(mine, *pair)
        except Fail:
            probe = evidence.probe
            if not probe.in_this_process(mine):
                # Nodes of a process of their own come into the graph one after the other.
                probe.wait_to_appear(lambda: len(self._ends(probe)) > len(given))
                self._given(evidence)
            raise

    def _ends(self, probe: Probe) -> list[Endpoint]:
        """Return what the node, or nodes, of that name have on the topic."""
        from labkit.rosgraph.endpoints import publishers, subscriptions

        ask = subscriptions if self.subscribes else publishers
        return [end for end in ask(probe.node, self.topic) if end.node == self.node]

    def _given(self, evidence: Evidence) -> list[Endpoint]:
        """Return the end of the given node, if it is as the lesson has made it."""
        probe = evidence.probe
        ends = self._ends(probe)
        for end in ends:
            is_given_here = is_given(end.node, probe.scope)
            if not is_given_here or not self.is_as_given(end.qos):
                what = 'with another profile' if is_given_here else 'which the lesson has not made'
                raise Fail(
                    f'{self.node} as the lesson has made it',
                    f'a node {self.node} {what}, {probe.place(end)}',
                    common_mistakes.GIVEN_IS_GONE.of(start=self.start),
                )
        return ends

    def _refuse_apart(self, mine: Endpoint, publisher: Endpoint, subscription: Endpoint) -> None:
        from labkit.rosgraph.matching import why_apart

        reason = why_apart(publisher, subscription)
        if reason:
            raise Fail(
                f'{subscription.node} hears {publisher.node} on {self.topic}',
                f'the two do not match: {reason[:1].lower()}{reason[1:]}',
                common_mistakes.OFFER_AND_REQUEST.of(
                    todo=f'Look at both profiles with %ros2 topic info --verbose {self.topic}, '
                    f'and change that of {mine.node}.'
                ),
            )


@dataclass(frozen=True)
class Latched(GraphClause):
    """What was published last is kept for subscriptions that come later, and nothing older.

    A clause on what is published stands before this one.

    Attributes:
        topic: Full name of the topic.
        words: What is asked for, in words of the task.
        field: Name of the field that tells one message from another.
    """

    topic: str
    words: str
    field: str = 'data'

    def find(self, evidence: Evidence) -> None:
        """Look at what the publisher offers."""
        source = evidence.publisher(self.topic)
        expect.qos(source, durability='transient_local')
        expect.qos(source, reliability='reliable')
        kept = source.qos.lifespan.nanoseconds * 1e-9
        expect.that(
            kept >= FOR_EVER_SEC,
            expected=f'{self.topic} without a lifespan',
            seen=f'{source.node} offers a lifespan of {figure(kept)} s',
            mistake=common_mistakes.KEPT_FOR_A_WHILE.of(seconds=kept),
        )

    def judge(self, evidence: Evidence) -> str:
        """Subscribe late, and look at what comes."""
        probe, source = evidence.probe, evidence.publisher(self.topic)
        said = evidence.life.on(self.topic)
        last = getattr(said[-1].message, self.field)
        watch = probe.watch(self.topic, source.msg_type, latched=True)
        # Of one publisher, messages come in their order: the newest one is the last.
        numbers = [sample.number for sample in said]
        probe.wait(
            lambda: any(sample.number >= max(numbers) for sample in watch.samples), KEPT_SEC
        )
        came = watch.values(self.field)
        if came[:1] == [last] and watch.samples[0].number >= max(numbers):
            return f'A late subscriber gets {show([last])} and nothing older.'
        if not came:
            raise Fail(
                f'{self.field} = {show([last])} for a subscription that comes late',
                'nothing',
                common_mistakes.NOT_KEPT,
            )
        raise Fail(
            f'the newest message only, {self.field} = {show([last])}',
            f'{many(len(came), "message")}: {self.field} = {show(came)}',
            common_mistakes.KEPT_TOO_MANY,
        )
