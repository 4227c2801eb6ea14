"""The cells of a notebook of labkit as tests, for `pytest --nbval`.

nbval finds the notebooks, reads the tags of their cells and makes a test of each code cell. A cell
is run by labkit, in the same way as by `python3 -m labkit record`, and what it shows is compared
with what is stored: all of it, exactly, but for the pixels of pictures and the traceback of an
error that is meant (its name and message are compared).
"""

from __future__ import annotations

import difflib
import json
import re
import shlex
from collections.abc import Iterator

import pytest
from nbformat import NotebookNode
from nbval.plugin import IPyNbCell, IPyNbFile

from labkit.course.lesson_run import CELL_TIMEOUT_SEC, LessonError, LessonRun, normalised
from labkit.course.record import LESSONS_DIR

__all__ = ['LessonFile']

PICTURES = ('image/png', 'image/jpeg')


class LessonFile(IPyNbFile):  # type: ignore[misc]
    """A lesson: its cells are tests, and share one kernel."""

    run: LessonRun | None = None

    def collect(self) -> Iterator[LessonCell]:
        """Make a test, named by the cell's id, of each code cell."""
        items = list(super().collect())
        places = [i for i, cell in enumerate(self.nb.cells) if cell.cell_type == 'code']
        for item, index in zip(items, places, strict=True):
            yield LessonCell.from_parent(
                self,
                name=item.cell.get('id', item.name),
                cell_num=index,
                cell=item.cell,
                options=item.options,
            )

    def setup(self) -> None:
        """Start the lesson's kernel."""
        limit = min(CELL_TIMEOUT_SEC, int(self.config.option.nbval_cell_timeout))
        self.run = LessonRun(self.path, cell_timeout_sec=limit)

    def teardown(self) -> None:
        """End the kernel and all that it has started."""
        if self.run is not None:
            self.run.close()


class OutputsDifferError(Exception):
    """What a cell shows is not what is stored; the text is the difference."""


class LessonCell(IPyNbCell):  # type: ignore[misc]
    """A code cell: it must run, and show what is stored."""

    def runtest(self) -> None:
        """Run the cell, and those before it that have not run yet; compare its outputs."""
        if self.options['skip']:
            pytest.skip('the cell is tagged nbval-skip')
        try:
            now = self.parent.run.execute(self.cell_num).outputs
        except LessonError:
            # nbval then expects the lesson's further cells to fail, and reports only this one.
            self.parent.timed_out = self.parent.run.broken
            raise
        if self.options['check']:
            # Stored outputs are in this form already, if `labkit record` has stored them.
            stored = normalised(self.cell.outputs, self.parent.run.folders())
            self._compare(_lines(stored), _lines(now))

    def _compare(self, stored: list[str], now: list[str]) -> None:
        if self.cell.execution_count is None:
            stored = ['(the cell has never been recorded)']
        if stored != now:
            diff = difflib.unified_diff(stored, now, 'stored', 'now', lineterm='')
            raise OutputsDifferError('\n'.join(map(_visible, diff)))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException]) -> str:
        """Say in which cell of which lesson what has gone wrong, and what to do."""
        error, lesson = excinfo.value, self.path.stem
        if isinstance(error, OutputsDifferError):
            what, details = 'it does not show what is stored', str(error)
            published = self.path.resolve().parent == LESSONS_DIR
            name = lesson if published else shlex.quote(str(self.path))
            todo = f'If the new output is right: python3 -m labkit record {name}'
        elif isinstance(error, LessonError):
            earlier = error.cell_id not in ('', self.name)
            before = f'cell {error.cell_id!r}, which runs before it: ' if earlier else ''
            what, details = before + error.message, error.traceback
            todo = 'Mend the cell, or what it calls; recording it anew does not help.'
        else:
            return str(super(IPyNbCell, self).repr_failure(excinfo))
        if self.config.option.color == 'no' or not self.config.get_terminal_writer().hasmarkup:
            details = re.sub(r'\x1b\[[\d;]*m', '', details)
        source = '\n'.join(f'    {line}' for line in self.cell.source.splitlines())
        title = f'Lesson {lesson}, cell {self.name!r}: {what}'
        return '\n\n'.join(part for part in (title, source, details, todo) if part)

    def reportinfo(self) -> tuple[object, int, str]:
        """Return the file, and the lesson and cell as a title."""
        return self.path, 0, f'{self.path.stem}::{self.name}'


def _lines(outputs: list[NotebookNode]) -> list[str]:
    """Return outputs as lines; two lists are the same if, and only if, the outputs are."""
    lines: list[str] = []
    for output in outputs:
        if output.output_type == 'stream':
            parts = {output.name: output.text}
        elif output.output_type == 'error':
            parts = {'error': f'{output.ename}: {output.evalue}'}
        else:
            parts = {f'{output.output_type}, {mime}': data for mime, data in output.data.items()}
        for title, content in sorted(parts.items()):
            if title.endswith(PICTURES):
                content = '(a picture)'
            elif not isinstance(content, str):
                content = json.dumps(content, indent=1, sort_keys=True)
            text = content.removesuffix('\n')
            broken_off = output.output_type == 'stream' and text == content
            lines.append(f'[{title}]' + ' (without a line break at the end)' * broken_off)
            lines += [f'  {line}' for line in text.split('\n')]
    return lines


def _visible(line: str) -> str:
    """Return a line with spaces at its end, and characters that have no form, made visible."""
    text = line.rstrip(' ')
    text = ''.join(c if c.isprintable() else c.encode('unicode_escape').decode() for c in text)
    return text + '·' * (len(line) - len(line.rstrip(' ')))
