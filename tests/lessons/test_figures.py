"""A figure in the words of a task is the one that its judge takes: both are one name.

That is read off the program: the words of a clause have names in braces for their figures, what
the program gives for them is made of names, and each of these stands in the code of a judge, too.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import TypeVar

import pytest
from proof import lessons

import labkit
from labkit.exercises import Exercise
from labkit.exercises.clauses import WITHIN
from labkit.exercises.words import files, sentences

ROOT = Path(labkit.__file__).parent
# What is 0 is not there; once, twice, one and half are said of single things.
FIGURE = re.compile(
    r'(?<![\w/.\-])(?!0(\.0)?\b)\d+(\.\d+)?(?!\w)'
    rf'|\b(three|four|five|six|seven|eight|nine|ten|twelve|twenty|thirty)\b|{WITHIN}'
)
NAME = re.compile('_?[A-Z][A-Z_]+')
Node = TypeVar('Node', bound=ast.AST)
# A square has four corners, with right angles.
MEANT = {'turtlebot-square': {'four', '90'}}
# Shorter pieces of text are found anywhere.
LEAST = 7

EXERCISES = [
    pytest.param(exercise, id=f'{lesson.name}-{exercise.name}')
    for lesson in lessons()
    for exercise in lesson.exercises
    if exercise.clauses
]


@pytest.mark.parametrize('exercise', EXERCISES)
def test_no_figure_of_a_task_is_written_a_second_time(exercise: Exercise) -> None:
    meant = MEANT.get(f'{exercise.lesson}-{exercise.name}', set())
    for clause in exercise.clauses:
        found = {f for text in written() if text in clause.text for f in figures(text)}
        assert found <= meant, clause.text


@pytest.mark.parametrize('exercise', EXERCISES)
def test_judge_takes_each_name_that_gives_a_task_its_figure(exercise: Exercise) -> None:
    texts = [clause.text for clause in exercise.clauses]
    for name in given():
        assert _without_texts(name) <= in_judges(), ast.unparse(name)
    for node in every(ast.JoinedStr):
        if _stands_in(node, texts):
            assert _without_texts(node) <= in_judges(), ast.unparse(node)


def figures(text: str) -> set[str]:
    return {found.group() for found in FIGURE.finditer(text)}


@cache
def modules() -> list[ast.Module]:
    paths = [*(ROOT / 'lessons').rglob('*.py'), *(ROOT / 'exercises').rglob('*.py')]
    left_out = 'solutions', 'quiz.py'
    return [ast.parse(path.read_text()) for path in paths if not {*left_out} & {*path.parts}]


@cache
def every(kind: type[Node]) -> list[Node]:
    return [node for module in modules() for node in ast.walk(module) if isinstance(node, kind)]


@cache
def written() -> list[str]:
    """Return the pieces of text with a figure in them; in pairs stand changes of programs."""
    changes = {id(part) for pair in every(ast.Tuple) for part in ast.iter_child_nodes(pair)}
    texts = [str(n.value) for n in every(ast.Constant) if id(n) not in changes]
    texts += [
        piece.strip()
        for path in files()
        if 'lessons' in path.parts
        for key, text in sentences(path).items()
        if key.startswith('clauses.')
        for piece in re.split(r'\{\w+\}', text)
    ]
    return [text for text in texts if len(text) >= LEAST and figures(text)]


@cache
def given() -> list[ast.expr]:
    """Return what words get for the names in their braces."""
    calls = [call for call in every(ast.Call) if _fills_words(call)]
    return [keyword.value for call in calls for keyword in call.keywords]


def _fills_words(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and ast.unparse(node.func) in ('WORDS.of', 'words.of')


@cache
def in_judges() -> set[str]:
    """Return the names that stand anywhere but in a text."""
    return {name for module in modules() for name in _outside(module)}


def _outside(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.JoinedStr) or _fills_words(node):
        return
    if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
        yield node.id
    for child in ast.iter_child_nodes(node):
        yield from _outside(child)


@cache
def texts() -> dict[str, ast.AST]:
    """Return the names of texts, each with what it is made of."""
    found: dict[str, ast.AST] = {}
    for assign in every(ast.Assign):
        sides = assign.targets[0], assign.value
        is_row = all(isinstance(side, ast.Tuple) for side in sides)
        for name, made in zip(*(side.elts for side in sides), strict=True) if is_row else [sides]:
            plain = isinstance(getattr(made, 'value', None), str)
            if isinstance(name, ast.Name) and (plain or isinstance(made, ast.JoinedStr)):
                found[name.id] = made
    return found


def _without_texts(node: ast.AST) -> set[str]:
    """Return the names in a text that are none of texts, and of those the names in them."""
    names = {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and NAME.fullmatch(n.id)}
    inside = [_without_texts(texts()[name]) for name in names if name in texts()]
    return names.difference(texts()).union(*inside)


def _stands_in(node: ast.JoinedStr, clauses: list[str]) -> bool:
    pieces = [str(n.value) for n in node.values if isinstance(n, ast.Constant)]
    return max((len(piece.strip()) for piece in pieces), default=0) >= LEAST and any(
        all(piece in text for piece in pieces) for text in clauses
    )
