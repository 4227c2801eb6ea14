"""Exercise: two nodes in a row, of which the second completes what the first begins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import WITHIN, Answers, Evidence, GraphClause, Publishes, Test
from labkit.exercises.draws import draw_texts
from labkit.lessons.my_name_is.stages import (
    COMPLETES,
    INNER,
    OPENING,
    STRING,
    says_opening,
)

__all__ = ['exercise']

WORDS = words_of(__file__)

OUTER = '/complete'
ONE_NODE = WORDS.mistake('two-stages/one-node')


@dataclass(frozen=True, eq=False)
class _Completes(Answers):
    """A stage appends a first name to each text. Which one that is, its first answer tells."""

    def tests(self, evidence: Evidence) -> Sequence[Test]:
        """Send nothing while stage one speaks, so that its own messages are its own."""
        return ()

    def judge(self, evidence: Evidence) -> str:
        """Judge the answers to texts of the check alone, and to what stage one says."""
        node = evidence.subscription(self.inner).node
        told = super().judge(evidence.alone(self, super().tests(evidence), node))
        super().judge(evidence)
        return told


class _TwoNodes(GraphClause):
    """Each stage is a node."""

    text = WORDS.clause('two-nodes')

    def find(self, evidence: Evidence) -> None:
        """Compare their names."""
        one = evidence.publisher(INNER).node
        if evidence.subscription(INNER).node == one:
            raise Fail(
                'two nodes, one for each stage',
                f'{one} publishes on {INNER} and subscribes to it',
                ONE_NODE,
            )


exercise = Exercise(
    words=WORDS,
    clauses=(
        Publishes(INNER, 2.0, STRING),
        says_opening(),
        _Completes(
            INNER,
            OUTER,
            STRING,
            WORDS.of(within=WITHIN).clause('completes'),
            draw=lambda: [OPENING, *draw_texts()],
            **COMPLETES,
        ),
        _TwoNodes(),
    ),
)
