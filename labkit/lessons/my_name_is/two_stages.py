"""Exercise: two nodes in a row, of which the second completes what the first begins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from labkit.exercises import Exercise, Fail, Mistake, Solution
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

OUTER = '/complete'
ONE_NODE = Mistake(
    'two-stages/one-node',
    'One node does the work of both stages, so neither can be replaced without the other.',
    'Write a class for each stage.',
)


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

    text = 'the two stages are two nodes'

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
    name='two_stages',
    task=f'Node one publishes {OPENING!r} on {INNER}, twice a second. Node two appends your first '
    f'name and publishes the whole on {OUTER}.',
    clauses=(
        Publishes(INNER, 2.0, STRING),
        says_opening(),
        _Completes(
            INNER,
            OUTER,
            STRING,
            f'for each text on `{INNER}`, publish it on `{OUTER}` with your first name appended '
            f'(both `{STRING}`), once, {WITHIN}',
            draw=lambda: [OPENING, *draw_texts()],
            **COMPLETES,
        ),
        _TwoNodes(),
    ),
    hints=[
        'Thermometer and Converter are such a chain. Which lines have to change?',
        'Stage one: a timer of 0.5 s and a publisher. Stage two: a subscription and a publisher, '
        'and no timer.',
        "In the callback of stage two: self.publisher.publish(String(data=msg.data + 'Ada')).",
    ],
    answer=Solution(
        __file__,
        'two_stages.py',
        'Each stage has one task and knows two topics at most. Stage two makes its text from the '
        'message that came, so it goes on working when stage one says something else.',
    ),
)
