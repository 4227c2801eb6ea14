"""Names in a lesson's own cells do not collide with what a learner forgets to write self before.

`publisher.publish(msg)` in a callback raises a NameError that tells what is missing, as long as no
cell of the lesson has left a variable of that name.
"""

from __future__ import annotations

import ast

import nbformat
import pytest
from IPython.core.inputtransformer2 import TransformerManager
from proof import lessons, notebook_of

from labkit.exercises import Lesson

# What opens a scope of its own: names in there are none of the notebook's.
_INNER = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp, ast.Lambda)


@pytest.mark.parametrize('lesson', lessons(), ids=lambda lesson: lesson.name)
def test_no_cell_of_a_lesson_has_a_name_of_what_solutions_keep(lesson: Lesson) -> None:
    programs = [e.answer.code for e in lesson.exercises if e.answer.name.endswith('.py')]
    kept = {
        node.attr
        for program in programs
        for node in ast.walk(ast.parse(program))
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) == 'self'
    }
    starters = {exercise.starter_id for exercise in lesson.exercises}
    for cell in nbformat.read(notebook_of(lesson), as_version=4).cells:
        if cell.cell_type == 'code' and cell.id not in starters:
            tree = ast.parse(TransformerManager().transform_cell(cell.source))
            assert not _bound(tree) & kept, cell.id


def _bound(tree: ast.AST) -> set[str]:
    """Return the names that a cell leaves in the notebook."""
    found: set[str] = set()
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            found.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
        elif not isinstance(node, _INNER):
            found |= _bound(node)
    return found
