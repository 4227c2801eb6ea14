"""How far a learner has come: as a picture, as text, as a table for a teacher."""

from __future__ import annotations

import argparse
import csv
import io
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from labkit.exercises.attempts import number_of, progress_store
from labkit.exercises.lesson import all_lessons
from labkit.views.progress_picture import Item, Row, picture, text_form

__all__ = ['ProgressView', 'main', 'progress']

COLUMNS = (
    *('lesson', 'kind', 'name', 'state', 'tries'),
    *('hints', 'solution_shown', 'first_try', 'passed_at'),
)


@dataclass(frozen=True, repr=False)
class ProgressView:
    """Progress as a picture in a notebook, and as text elsewhere.

    Attributes:
        rows: One a lesson.
        note: Something about the file.
    """

    rows: Sequence[Row]
    note: str = ''

    def __repr__(self) -> str:
        return text_form(self.rows, self.note)

    def _repr_html_(self) -> str:
        return picture(self.rows, self.note)


def progress() -> ProgressView:
    """Return your progress, to be shown by the notebook: what is done, tried and still to do."""
    data, note = progress_store.store.read()
    aside = progress_store.store.damaged_files()
    if aside and not note:
        note = f'Damaged progress files that were kept aside: {", ".join(p.name for p in aside)}'
    rows = []
    for title, entries in _entries(data):
        items = [Item(entry['kind'], entry['name'], entry['state']) for entry in entries]
        rows.append(Row(title, items))
    return ProgressView(rows, note)


def main(argv: Sequence[str] | None = None) -> int:
    """Show progress on the command line, or write it as CSV.

    Args:
        argv: Arguments after `labkit progress`.

    Returns:
        Exit code.
    """
    parser = argparse.ArgumentParser(
        prog='labkit progress', description='Show which exercises and quiz questions are done.'
    )
    parser.add_argument(
        '--csv', action='store_true', help='write a table, one line an exercise or question'
    )
    options = parser.parse_args(argv)
    if not options.csv:
        print(progress())
        return 0
    data, note = progress_store.store.read()
    if note:
        print(note, file=sys.stderr)
    table = io.StringIO()
    writer = csv.DictWriter(table, COLUMNS, lineterminator='\n')
    writer.writeheader()
    for _, entries in _entries(data):
        writer.writerows(entries)
    # At once, so that a reader that has seen enough (`| head`) does no harm.
    print(table.getvalue(), end='')
    return 0


def _entries(data: dict[str, Any]) -> list[tuple[str, list[dict[str, Any]]]]:
    """Return title and table lines of each lesson, those not begun included."""
    found = []
    for lesson in all_lessons():
        known = data['lessons'].get(lesson.name, {})
        names = [('exercise', exercise.name) for exercise in lesson.exercises]
        names += [
            ('question', f'{quiz.name}.{number}')
            for quiz in lesson.quizzes
            for number in range(1, len(quiz) + 1)
        ]
        lines = [
            _line(lesson.name, kind, name, known.get(f'{kind}s', {}).get(name, {}))
            for kind, name in names
        ]
        found.append((lesson.notebook.removesuffix('.ipynb'), lines))
    return found


def _line(lesson: str, kind: str, name: str, entry: dict[str, Any]) -> dict[str, Any]:
    passed, tries = entry.get('passed_at', ''), number_of(entry.get('tries'))
    return {
        'lesson': lesson,
        'kind': kind,
        'name': name,
        'state': 'done' if passed else 'tried' if tries else 'open',
        'tries': tries,
        'hints': number_of(entry.get('hints')),
        'solution_shown': 'yes' if entry.get('solution') is True else 'no',
        'first_try': entry.get('first_try', ''),
        'passed_at': passed,
    }
