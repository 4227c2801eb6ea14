"""Answers to the exercises, right ones and wrong ones, and what each of them must get.

A mistake whose id begins with the name of an exercise, and that has a change of its solution, is a
wrong answer to it, and must be told in its own words.
`cases/<lesson>/<exercise>.py` is the table of the others: `ANSWERS`, of rows made by `wrong` and
`right`. A row says what is changed in the exercise's solution. Where there is a file
`cases/<lesson>/<exercise>/<name_of_the_row>.py` (`.ipy` if it has magics, `.sh` for a terminal),
that program stands in the place of the solution. What every exercise has is generated from its
solution, see `generic`: a row of such a name, without changes, says what becomes of it here.
"""

from __future__ import annotations

import functools
import importlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from cases.generic import KINDS, generated, usual
from cases.scripts import RUNS
from labkit.exercises import Exercise, Outcome
from labkit.exercises.exercise import read_answer
from labkit.exercises.mistakes import HOLE, Mistake, known_mistakes

__all__ = [
    'ERROR',
    'NOT_ATTEMPTED',
    'Answer',
    'Row',
    'answers_of',
    'changes_of',
    'right',
    'slug',
    'wrong',
]

HERE = Path(__file__).resolve().parent
ERROR, NOT_ATTEMPTED = Outcome.ERROR, Outcome.NOT_ATTEMPTED
SUFFIXES = ('.py', '.ipy', '.sh')


@dataclass(frozen=True)
class Row:
    """A row of the table of an exercise: see `right` and `wrong`."""

    name: str
    changes: Sequence[tuple[str, str]]
    outcome: Outcome
    says: str = ''
    of: str = ''
    run: str = ''
    refused: str = ''


@dataclass(frozen=True)
class Answer:
    """An answer to an exercise, and the verdict that it must get.

    Attributes:
        exercise: Name of the exercise.
        name: What the answer is, such as `'starts at 0'`.
        code: What stands in the starter cell; as it is in the notebook if None.
        outcome: The outcome that it must get.
        says: A sentence, or a part of one, that the verdict must contain.
        process: Whether it is a script for a process of its own.
        refused: What a linter finds in it, where that is the mistake; `''` if it finds nothing.
    """

    exercise: str
    name: str
    code: str | None
    outcome: Outcome
    says: str = ''
    process: bool = False
    refused: str = ''


def right(name: str, *changes: tuple[str, str], of: str = '', run: str = '') -> Row:
    """Return an answer that must pass: the solution in another style.

    Args:
        name: What it is called, such as `'functions'`.
        changes: Pairs of what stands in the solution, exactly, and what stands there instead.
        of: Name of the answer that is changed, if it is not the solution.
        run: How it is started, if not in the cell: as a `'process'` of its own, with `'two
            copies'` of its node in there, or from the cell by `'subprocess'` or by `'asyncio'`.
    """
    return Row(name, changes, Outcome.PASS, of=of, run=run)


def wrong(
    name: str,
    says: str,
    *changes: tuple[str, str],
    outcome: Outcome = Outcome.FAIL,
    of: str = '',
    run: str = '',
    refused: str = '',
) -> Row:
    """Return a typical wrong answer.

    Args:
        name: What it is called, such as `'starts at 0'`.
        says: A sentence, or a part of one, that the verdict must contain.
        changes: As for `right`.
        outcome: FAIL, ERROR if the code raises, or NOT_ATTEMPTED if nothing of it is left.
        of: As for `right`.
        run: As for `right`.
        refused: What a linter finds in it, where that is the mistake.
    """
    return Row(name, changes, outcome, says, of, run, refused)


@functools.cache
def answers_of(exercise: Exercise) -> list[Answer]:
    """Return the answers to an exercise: those of its table, and the generated ones.

    They are made once, by the thread that collects the tests: Python 3.11 may fail where two
    threads parse code at a time (SystemError, "AST constructor recursion depth mismatch").

    Raises:
        ValueError: What a row changes is not there.
    """
    name = f'{exercise.lesson}.{exercise.name}'
    table: Sequence[Row] = [
        *map(_row_of, changes_of(exercise)),
        *_table(name),
    ]
    rows = {row.name: row for row in table}
    if len(rows) < len(table):
        raise ValueError(f'Two answers to {name} have one name.')
    for kind in KINDS:
        if kind not in rows and generated(kind, exercise) is not None:
            rows[kind] = Row(kind, (), *usual(kind, exercise))
    folder = HERE / exercise.lesson / exercise.name
    return [
        Answer(
            exercise.name,
            row.name,
            RUNS[run](code) if run else code,
            row.outcome,
            row.says,
            process=run in ('process', 'two copies'),
            refused=row.refused,
        )
        for row in rows.values()
        for code, run in [_code(row, rows, exercise, folder)]
    ]


def changes_of(exercise: Exercise) -> list[Mistake]:
    """Return the mistakes of an exercise, which are named after it, as far as one can make them.

    Some lessons have an underscore in those ids, as in the name; the others have a dash. The
    lesson of the tests has exercises of the same names as others, so its ids begin with `demo-`.
    """
    own = 'demo-' * (exercise.lesson == 'demo')
    begin = own + exercise.name.replace('_', '-')
    return [
        mistake
        for name, mistake in known_mistakes().items()
        if mistake.change and name.partition('/')[0].replace('_', '-') == begin
    ]


def _table(name: str) -> Sequence[Row]:
    """Return the table of an exercise; one whose mistakes say all has none."""
    try:
        rows: Sequence[Row] = importlib.import_module(f'cases.{name}').ANSWERS
    except ModuleNotFoundError:
        return ()
    return rows


def _row_of(mistake: Mistake) -> Row:
    """Return the program that has a mistake of the course: it must be told in its own words."""
    words = max(mistake.sentence.split(HOLE), key=len).strip()
    return wrong(
        mistake.id.rpartition('/')[2].replace('-', ' '),
        mistake.raises or words,
        *mistake.change,
        outcome=ERROR if mistake.raises else Outcome.FAIL,
    )


def _code(row: Row, rows: Mapping[str, Row], exercise: Exercise, folder: Path) -> tuple[str, str]:
    """Return the code of a row in a cell, and how it is started."""
    own = [path for path in folder.glob(f'{slug(row.name)}.*') if path.suffix in SUFFIXES]
    if row.of:
        code, _ = _code(rows[row.of], rows, exercise, folder)
    elif own:
        code = read_answer(own[0])
    elif row.changes or row.run:
        code = exercise.answer.code
    else:
        made = generated(row.name, exercise)
        if made is None:
            raise ValueError(f'{row.name}: no changes, no file in {folder}, and not generated.')
        return made, KINDS[row.name].run
    for old, new in row.changes:
        if old not in code:
            raise ValueError(f'{row.name}: {old!r} is not in the code:\n{code}')
        code = code.replace(old, new)
    return code, row.run


def slug(name: str) -> str:
    """Return what the file of a row is called, without its ending."""
    return re.sub(r'\W+', '_', name.lower()).strip('_')
