"""Clauses on quality of service: who matches whom, and what is kept for who comes later."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from labkit.exercises import expect
from labkit.exercises.callbacks import is_given
from labkit.exercises.clauses.base import Clause, Evidence
from labkit.exercises.expect.values import show
from labkit.exercises.verdict import Fail, NotAttempted

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe
    from labkit.rosgraph.endpoints import Endpoint

__all__ = ['Latched', 'Matches']

# How long what was kept may take to arrive from another process, s.
KEPT_SEC = 5.0


@dataclass(frozen=True, eq=False)
class Matches(Clause):
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

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words

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
            if not is_given(end.node, probe.scope) or not self.is_as_given(end.qos):
                raise Fail(
                    f'{self.node} as the lesson has made it',
                    f'another node of that name, {probe.place(end)}',
                    why='On a robot that end belongs to somebody else: you can not change it.',
                    todo='End it, and change your own node. If that of the lesson is gone: '
                    f'{self.start}',
                )
        return ends

    def _refuse_apart(self, mine: Endpoint, publisher: Endpoint, subscription: Endpoint) -> None:
        from labkit.rosgraph.matching import why_apart

        reason = why_apart(publisher, subscription)
        if reason:
            raise Fail(
                f'{subscription.node} hears {publisher.node} on {self.topic}',
                f'the two do not match: {reason[:1].lower()}{reason[1:]}',
                why='A publisher offers, and a subscription asks. Where it asks for more than is '
                'offered, no message passes.',
                todo=f'Look at both profiles with %ros2 topic info --verbose {self.topic}, and '
                f'change that of {mine.node}.',
            )


@dataclass(frozen=True)
class Latched(Clause):
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

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words

    def find(self, evidence: Evidence) -> None:
        """Look at what the publisher offers."""
        source = evidence.publisher(self.topic)
        expect.qos(source, durability='transient_local')
        expect.qos(source, reliability='reliable')

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
        if came[:1] == [last]:
            return f'Who comes late hears {show([last])}, and nothing older.'
        if not came:
            raise Fail(
                f'{self.field} = {show([last])} for a subscription that comes late',
                'nothing',
                why='What was published is not kept.',
                todo='Keep one publisher as long as the node lives: self.publisher.',
            )
        raise Fail(
            f'the newest message only, {self.field} = {show([last])}',
            f'{len(came)} messages: {self.field} = {show(came)}',
            why='A publisher with durability transient local keeps as many messages as its depth '
            'says. The older ones are heard first.',
            todo='Give the profile of the publisher depth=1.',
        )
