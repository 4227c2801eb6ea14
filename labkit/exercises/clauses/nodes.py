"""Clauses on which nodes there are."""

from __future__ import annotations

from dataclasses import dataclass

from labkit.exercises import expect
from labkit.exercises.clauses.base import Clause, Evidence

__all__ = ['Named', 'Subscribes']


@dataclass(frozen=True)
class Named(Clause):
    """There is one node of a name.

    Attributes:
        node: Full name of the node. It is in `nodes` of the exercise, too.
    """

    node: str

    @property
    def text(self) -> str:
        """What is asked for."""
        return f'the name of the node is `{self.node.lstrip("/")}`'

    def find(self, evidence: Evidence) -> None:
        """Look for the node."""
        expect.node(evidence.probe, self.node)


@dataclass(frozen=True)
class Subscribes(Clause):
    """A node subscribes to a topic.

    Attributes:
        topic: Full name of the topic. Its type is in the `subscribes` of the exercise.
        msg_type: Name of the type, for the words of the task.
        by: Full name of the node; any node if empty.
    """

    topic: str
    msg_type: str
    by: str = ''

    @property
    def text(self) -> str:
        """What is asked for."""
        return f'subscribe to `{self.topic}` (`{self.msg_type}`)'

    def find(self, evidence: Evidence) -> None:
        """Look for the subscription."""
        evidence.subscription(self.topic, self.by)
