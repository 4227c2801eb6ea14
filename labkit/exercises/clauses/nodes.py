"""Clauses on which nodes there are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from labkit.exercises import common_mistakes, expect
from labkit.exercises.clauses.base import Evidence, GraphClause
from labkit.exercises.expect import spinning
from labkit.exercises.verdict import Fail
from labkit.exercises.what_is_asked import NODE, SUBSCRIPTION, Role
from labkit.exercises.words import words_of

__all__ = ['Named', 'NobodyElse', 'Runs', 'Subscribes']

WORDS = words_of(__file__)


@dataclass(frozen=True)
class Named(GraphClause):
    """There is one node of a name.

    Attributes:
        node: Full name of the node.
    """

    node: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return WORDS.of(node=self.node.lstrip('/')).clause('named')

    @property
    def roles(self) -> dict[Role, str]:
        """There is such a node."""
        return {(NODE, self.node): ''}

    def find(self, evidence: Evidence) -> None:
        """Look for the node."""
        expect.node(evidence.probe, self.node)


@dataclass(frozen=True)
class Subscribes(GraphClause):
    """A node subscribes to a topic.

    Attributes:
        topic: Full name of the topic.
        msg_type: Name of the type.
        by: Full name of the node; any node if empty.
    """

    topic: str
    msg_type: str
    by: str = ''

    @property
    def text(self) -> str:
        """What is asked for."""
        return WORDS.of(topic=self.topic, msg_type=self.msg_type).clause('subscribes')

    @property
    def roles(self) -> dict[Role, str]:
        """It subscribes."""
        return {(SUBSCRIPTION, self.topic): self.msg_type}

    def find(self, evidence: Evidence) -> None:
        """Look for the subscription."""
        evidence.subscription(self.topic, self.by)


@dataclass(frozen=True)
class NobodyElse(GraphClause):
    """On a topic that others may share, only these nodes publish.

    Attributes:
        topic: Full name of the topic.
        nodes: Full names of the nodes.
    """

    topic: str
    nodes: Sequence[str]

    @property
    def text(self) -> str:
        """What is asked for."""
        return WORDS.of(topic=self.topic).clause('nobody-else')

    def judge(self, evidence: Evidence) -> str:
        """Look who publishes."""
        found = {end.node for end in evidence.probe.publishers(self.topic)}
        others = sorted(found.difference(self.nodes))
        if others:
            raise Fail(
                f'publishers on {self.topic}: {", ".join(self.nodes)}, and no other',
                f'{", ".join(others)} publishes there, too',
                common_mistakes.OTHERS_SHARE.of(other=others[0]),
            )
        return ''


@dataclass(frozen=True)
class Runs(GraphClause):
    """Somebody runs the callbacks of a node, and none of them holds the others up.

    Attributes:
        words: What is asked for, in words of the task.
        node: Full name of the node; if empty, the one that publishes on a topic.
        topic: Full name of that topic.
    """

    words: str
    node: str = ''
    topic: str = ''

    def find(self, evidence: Evidence) -> None:
        """Ask the node."""
        probe = evidence.probe
        name = self.node or evidence.publisher(self.topic).node
        spinning.hanging()
        here = probe.node_object(name) is not None
        if not spinning.runs(probe, name):
            raise Fail(
                f'{name} runs: its callbacks are called when their time has come',
                f'{name} is there, but it is not spun',
                spinning.not_spun(
                    probe,
                    name,
                    (common_mistakes.NOT_SPUN if here else common_mistakes.PROGRAM_WAITS).of(
                        spin=spinning.how_to_spin(probe, name)
                    ),
                ),
            )
