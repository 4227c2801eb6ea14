"""A learner's progress as a picture, as text, and as CSV."""

from __future__ import annotations

import argparse
import csv
import io
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from typing import TYPE_CHECKING

from labkit import settings
from labkit.background.runtime import runtime
from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.lesson_progress import days, days_in_a_row, entries, onward, row_of
from labkit.exercises.record.progress_store import progress_store
from labkit.views.course_map import course_map, earned
from labkit.views.progress_picture import Row, picture, text_form

if TYPE_CHECKING:
    from IPython.display import DisplayHandle

__all__ = ['ProgressView', 'main', 'progress']

COLUMNS = (
    *('lesson', 'kind', 'name', 'state', 'tries'),
    *('hints', 'solution_shown', 'first_try', 'passed_at'),
)


@dataclass(frozen=True, repr=False)
class ProgressView:
    """Progress as a picture in a notebook, and as text elsewhere.

    Attributes:
        rows: One row per lesson.
        note: A note on the progress file.
        onward: Places to continue, as pairs of a text and a link.
        days: The days on which the learner has worked, in order.
    """

    rows: Sequence[Row]
    note: str = ''
    onward: Sequence[tuple[str, str]] = ()
    days: Sequence[date] = ()

    def __repr__(self) -> str:
        return text_form(self.rows, self.note)

    def _repr_html_(self) -> str:
        here = self.onward[0][1].partition('#')[0] if self.onward else ''
        above = course_map(self.rows, here)
        count = days_in_a_row(self.days, date.today())
        if count > 1:
            above += f'\n<p style="margin:0 0 0.6em">{count} days in a row.</p>'
        exercises = [item for row in self.rows for item in row.of_kind('exercise')]
        if self.days and all(item.state == 'done' for item in exercises):
            above += f'\n{earned(self.rows, self.days[0], self.days[-1])}'
        return picture(self.rows, self.note, self.onward, above=above)

    def _ipython_display_(self) -> None:
        if not settings.audience().live:
            raise NotImplementedError  # IPython then asks for text and HTML
        from IPython.display import display

        cell = runtime.console.current_cell().cell_id
        _shown[cell] = display(self._bundle(), raw=True, display_id=True)  # type: ignore[no-untyped-call]
        if _refresh not in progress_store.after_change:
            progress_store.after_change.append(_refresh)

    def _bundle(self) -> dict[str, str]:
        return {'text/plain': repr(self), 'text/html': self._repr_html_()}


# Where progress is shown in this notebook: one place for each cell.
_shown: dict[str, DisplayHandle] = {}


def _refresh() -> None:
    if _shown:
        bundle = progress()._bundle()
        for place in list(_shown.values()):
            place.update(bundle, raw=True)  # type: ignore[no-untyped-call]


def progress() -> ProgressView:
    """Return your progress, to be shown by the notebook: what is done, tried and still to do."""
    data, note = progress_store.store.read()
    aside = progress_store.store.damaged_files()
    if aside and not note:
        note = f'Damaged progress files that were kept aside: {", ".join(p.name for p in aside)}'
    rows = [row_of(lesson, data) for lesson in all_lessons()]
    return ProgressView(rows, note, onward(data, all_lessons()), days(data))


def main(argv: Sequence[str] | None = None) -> int:
    """Show progress on the command line, or write it as CSV; return the exit code."""
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
    for lesson in all_lessons():
        writer.writerows(entries(lesson, data))
    # In one piece, so that a reader that stops early (`| head`) does no harm.
    print(table.getvalue(), end='')
    return 0
