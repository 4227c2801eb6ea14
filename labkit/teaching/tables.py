"""A class as tables: all data, and a grade book for learning platforms."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from datetime import datetime

from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.quiz.questions import LETTERS
from labkit.exercises.record.class_sheet import Entry, catalogue
from labkit.teaching.class_folder import Learner
from labkit.teaching.counting import remarks

__all__ = ['gradebook', 'table']

_COLUMNS = (
    *('learner', 'lesson', 'kind', 'name', 'state', 'tries', 'hints', 'solution_shown'),
    *('first_try', 'passed_at', 'last', 'remark'),
)
# Spreadsheets take a cell that begins with one of these as a formula: owasp.org, "CSV Injection".
_FORMULA = ('=', '+', '-', '@', '\t', '\r')


def table(learners: Sequence[Learner], now: datetime) -> str:
    """Return all data of a class as CSV, one line per learner and exercise, question or guess.

    Args:
        learners: The learners. One without a usable sheet gets one line that says so.
        now: The time on the teacher's computer.
    """
    known = catalogue()
    rows: list[Sequence[object]] = [_COLUMNS]
    for learner in learners:
        if learner.sheet is None:
            remark = f'can not be used: {learner.trouble}'
            rows.append([learner.name, *[''] * (len(_COLUMNS) - 2), remark])
            continue
        remark = ', '.join(remarks(learner.sheet, now))
        for key in known:
            entry = learner.sheet.entries.get(key, Entry())
            rows.append([learner.name, *key, *_cells(entry), remark])
    return _csv(rows)


def gradebook(learners: Sequence[Learner]) -> str:
    """Return a class as a grade book: a line per learner, a column per lesson, in percent.

    The format of Moodle's grade import (docs.moodle.org, "Grade import"): a header, a column with
    the user name, a column per grade, which is mapped to an item or creates one. Other platforms
    with column mapping read the same.

    Args:
        learners: The learners. One without a usable sheet is left out: no grade is not a zero.
    """
    lessons = [lesson for lesson in all_lessons() if lesson.exercises]
    rows: list[Sequence[object]] = [['username', *(lesson.heading for lesson in lessons)]]
    for learner in learners:
        if learner.sheet is None:
            continue
        entries = learner.sheet.entries
        grades = []
        for lesson in lessons:
            keys = [(lesson.name, 'exercise', exercise.name) for exercise in lesson.exercises]
            passed = sum(entries.get(key, Entry()).passed_at is not None for key in keys)
            grades.append(round(100 * passed / len(keys), 2))
        rows.append([learner.name, *grades])
    return _csv(rows)


def _cells(entry: Entry) -> list[object]:
    state = 'done' if entry.passed_at else 'tried' if entry.tries else 'open'
    shown = 'yes' if entry.solution else 'no'
    times = [_when(entry.first_try), _when(entry.passed_at)]
    # Of a guess, what was chosen before the answer was known, and after it.
    chosen = [LETTERS[index] for index in (entry.before, entry.after) if index is not None]
    return [state, entry.tries, entry.hints, shown, *times, entry.last or ' > '.join(chosen)]


def _when(time: datetime | None) -> str:
    return time.isoformat() if time is not None else ''


def _csv(rows: Iterable[Sequence[object]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator='\n').writerows(
        [_safe(value) for value in row] for row in rows
    )
    return text.getvalue()


def _safe(value: object) -> object:
    """Return a cell value that no spreadsheet takes for a formula."""
    if isinstance(value, str) and value.lstrip().startswith(_FORMULA):
        return f"'{value}"
    return value
