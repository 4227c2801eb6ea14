"""Which run of a cell a verdict is about: what failed later, and what was changed since.

A node outlives the run of the cell that has made it. So a check may find one that was right, under
a cell that is red now, or one of a class that its cell says otherwise by now. What ran last is
what the learner looks at, and is told first.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from labkit.exercises import common_mistakes
from labkit.exercises.attempts import definition
from labkit.exercises.learner_errors import Run, last_cell
from labkit.exercises.mistakes import Mistake
from labkit.exercises.verdict import Outcome, Verdict

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe

__all__ = ['Judged', 'changed_since', 'failed_last', 'judged_nodes', 'told_of_older']


@dataclass(frozen=True)
class Judged:
    """A node of this notebook that a check has judged.

    Attributes:
        name: Its full name.
        node: The node.
        cell_id: The id of the cell that has made it, `''` if that is not known.
        number: Which execution of the notebook that was.
    """

    name: str
    node: Any
    cell_id: str
    number: int

    def __str__(self) -> str:
        return f'{self.name} of run {self.number}'


def judged_nodes(probe: Probe) -> list[Judged]:
    """Return the nodes of this notebook that are an attempt, and of which it is known who made."""
    from labkit.background.nodes import made

    found = []
    for name in sorted(probe.attempt()):
        node = probe.node_object(name)
        origin = made.origins.get(node) if node is not None else None
        if origin is not None and origin.cell.number:
            found.append(Judged(name, node, origin.cell.cell_id, origin.cell.number))
    return found


def failed_last(starter_id: str, judged: Sequence[Judged], *, passed: bool) -> Run | None:
    """Return the run of a cell that failed when it ran last, if it is what is to be told.

    Whatever else has failed is no reason to refuse a right answer: only the cell of the exercise
    is, or one that has made its nodes. A node that was made later is another attempt.

    Args:
        starter_id: Id of the cell of the exercise.
        judged: The nodes that were judged.
        passed: Whether they do what the task asks for.
    """
    newest = max((each.number for each in judged), default=0)
    own = {'', starter_id, *(each.cell_id for each in judged)}
    for run in (last_cell.run, last_cell.run_of(starter_id)):
        if run is None or run.error is None or run.number < newest:
            continue
        if not passed or (judged and run.cell_id in own):
            return run
    return None


def told_of_older(judged: Sequence[Judged], failed: Run, verdict: Verdict) -> str:
    """Return what nodes do that are older than a run that has failed; `''` if there are none."""
    older = [str(each) for each in judged if each.number < failed.number]
    if not older or verdict.outcome is Outcome.NOT_ATTEMPTED:
        return ''
    some, runs = ('An older node', 'runs') if len(older) == 1 else ('Older nodes', 'run')
    begin = f'{some}, {", ".join(older)}, still {runs}'
    if verdict.passed:
        return f'{begin}, and {"does" if len(older) == 1 else "do"} what the task asks for.'
    return f'{begin}. Of it the check says: {verdict.seen or verdict.text}'


def changed_since(judged: Sequence[Judged]) -> tuple[Judged, Mistake] | None:
    """Return a node whose class a cell has changed since it was made, and what is to be said."""
    from labkit.background.nodes import made

    space = vars(sys.modules['__main__'])
    for each in judged:
        kind = type(each.node)
        now = space.get(kind.__name__)
        if now is kind or not isinstance(now, type) or now in made.kinds():
            continue
        before, after = definition(kind), definition(now)
        if before is None or after is None or ast.dump(before) == ast.dump(after):
            continue
        mistake = common_mistakes.CLASS_CHANGED
        values = {'name': kind.__name__, 'node': each.name, 'number': each.number}
        return each, mistake.of(**values)
    return None
