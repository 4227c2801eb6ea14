"""The mutants of an exercise: its solution with one change each, always the same ones."""

from __future__ import annotations

import ast
import difflib
import json
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import nbformat
from IPython.core.inputtransformer2 import TransformerManager
from mutants.changes import Change, plain_changes, statement_changes
from mutants.command_changes import command_changes
from mutants.ros_changes import free_constants, ros_changes
from proof import notebook_of

from labkit.exercises import Exercise, Lesson

__all__ = ['Mutant', 'equivalents', 'mutants_of', 'parsed']

# A program in a string is one line.
LINE = 240
EQUIVALENT = Path(__file__).with_name('equivalent.json')


@dataclass(frozen=True)
class Mutant:
    """A solution with one change.

    Attributes:
        id: `'<lesson>-<exercise>-<kind>-<number>'`.
        exercise: `'<lesson>-<exercise>'`.
        code: What stands in the starter cell.
        diff: What was changed and where, on one line, for people.
    """

    id: str
    exercise: str
    code: str
    diff: str


def equivalents() -> dict[str, dict[str, str]]:
    """Return the mutants that do what the task asks for: exercise -> diff -> reason."""
    known: dict[str, dict[str, str]] = json.loads(EQUIVALENT.read_text(encoding='utf-8'))
    return known


def mutants_of(lesson: Lesson, exercise: Exercise) -> list[Mutant]:
    """Return the mutants of an exercise, each change once, none that is equal to the solution."""
    code = exercise.answer.code
    if code.startswith('%%'):
        solution, found = code.strip(), _of_terminal(code.strip(), _task(lesson, exercise))
    elif code.startswith('%'):
        solution, found = code.strip(), _of_commands(code.strip())
    else:
        solution = ast.unparse(parsed(code))
        found = _of_program(solution, _task(lesson, exercise))
    name, mutants, seen = f'{lesson.name}-{exercise.name}', [], {solution}
    numbers: Counter[str] = Counter()
    for kind, mutant, diff in found:
        # Blank lines of a program in a string are no change.
        if diff and seen.isdisjoint({mutant, diff}):
            seen.update({mutant, diff})
            numbers[kind] += 1
            mutants.append(Mutant(f'{name}-{kind}-{numbers[kind]}', name, mutant, diff))
    return mutants


def parsed(code: str) -> ast.Module:
    """Return the tree of a cell; its magics and shell commands are calls there."""
    return ast.parse(TransformerManager().transform_cell(code))


def _task(lesson: Lesson, exercise: Exercise) -> str:
    """Return the text that stands before the cell to edit."""
    text = ''
    for cell in nbformat.read(notebook_of(lesson), as_version=4).cells:
        if cell.id == exercise.starter_id:
            break
        text = cell.source if cell.cell_type == 'markdown' else text
    return text


def _of_commands(code: str) -> Iterator[tuple[str, str, str]]:
    for kind, mutant in command_changes(code):
        yield kind, mutant, _diff(code, mutant)


def _of_terminal(code: str, task: str) -> Iterator[tuple[str, str, str]]:
    """Give what is made of the first program that lines of a terminal write into a file.

    If they write none, a line is missing, or comes later.
    """
    before, begin, rest = code.partition('<< END\n')
    if begin:
        program, end, after = rest.partition('END\n')
        for kind, mutant, diff in _of_program(ast.unparse(ast.parse(program)), task):
            yield kind, f'{before}{begin}{mutant}\n{end}{after}', diff
        return
    magic, *lines = [line for line in code.splitlines() if not line.startswith('#')]
    solution = '\n'.join([magic, *lines])
    for i, line in enumerate(lines):
        left = [*lines[:i], *lines[i + 1 :]]
        for kind, others in ('removed', left), ('later', [*left[: i + 1], line, *left[i + 1 :]]):
            mutant = '\n'.join([magic, *others])
            yield kind, mutant, _diff(solution, mutant)


def _of_program(code: str, task: str) -> Iterator[tuple[str, str, str]]:
    """Give what is made of a program; of the one in a string, if it starts that one."""
    tree = ast.parse(code)
    inner = next(filter(_is_program, ast.walk(tree)), None)
    if not isinstance(inner, ast.Constant):
        yield from _texts(code, plain_changes(tree, free_constants(tree, task)))
        yield from _texts(code, ros_changes(code))
        return
    program = ast.unparse(ast.parse(str(inner.value)))
    for kind, mutant, diff in _of_program(program, task):
        start, _, end = code.partition(repr(inner.value))
        yield kind, f'{start}{mutant!r}{end}', diff
    yield from _texts(code, statement_changes(tree))


def _is_program(node: ast.AST) -> bool:
    text = getattr(node, 'value', None)
    return isinstance(node, ast.Constant) and isinstance(text, str) and 'import' in text


def _texts(code: str, changes: Iterable[Change]) -> Iterator[tuple[str, str, str]]:
    """Give kind, code and diff of each change that can be compiled."""
    for kind, text in changes:
        try:
            compile(text, 'mutant', 'exec')
        except SyntaxError:
            continue
        yield kind, text, _diff(code, text)


def _diff(old: str, new: str) -> str:
    """Return the lines that differ, and in which class and function the first of them is."""
    before, after = old.splitlines(), new.splitlines()
    parts, where = [], ''
    for tag, i, end, j, new_end in difflib.SequenceMatcher(None, before, after).get_opcodes():
        if tag == 'equal' or _imports_more(tag, after[j:new_end]):
            continue
        parts += [f'- {_short(line)}' for line in before[i:end] if line.strip()]
        parts += [f'+ {_short(line)}' for line in after[j:new_end] if line.strip()]
        if tag == 'insert' and ''.join(before[i : i + 1]).strip():
            parts[-1] += f' (before {_short(before[i])})'
        where = where or _where(after, j)
    return f'{where}{" | ".join(parts)}'


def _imports_more(tag: str, lines: list[str]) -> bool:
    """Tell whether lines only import what another line of the change needs."""
    return tag == 'insert' and all(line.startswith('from ') for line in lines)


def _short(line: str) -> str:
    line = line.strip()
    return line if len(line) <= LINE else f'{line[:LINE]}...'


def _where(lines: list[str], index: int) -> str:
    """Return the names of the class and the function around a line, `'Talker.on_timer: '`."""
    names: list[str] = []
    line = lines[index] if index < len(lines) else ''
    indent = len(line) - len(line.lstrip())
    for line in reversed(lines[:index]):
        words, own = line.split(), len(line) - len(line.lstrip())
        if words and own < indent:
            indent = own
            if words[0] in ('class', 'def'):
                names.insert(0, words[1].partition('(')[0].rstrip(':'))
    return f'{".".join(names)}: ' if names else ''
