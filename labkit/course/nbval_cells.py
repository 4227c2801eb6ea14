"""The cells of a notebook of labkit as tests, for `pytest --nbval`.

nbval finds the notebooks, reads the tags and comments of their cells, and makes a test of each
code cell; its options hold here, too (docs/nbval.md). A cell is run by labkit, in the same way as
by `python3 -m labkit record`. What nbval compares of its outputs, after its replacements
(`--nbval-sanitize-with`), must be what is stored, also in its order.
"""

from __future__ import annotations

import difflib
import hashlib
import json
import re
import shlex
from collections.abc import Callable, Iterator
from copy import deepcopy
from types import SimpleNamespace

import pytest
from nbformat import NotebookNode
from nbval.cover import setup_coverage, teardown_coverage
from nbval.plugin import IPyNbCell, IPyNbFile, coalesce_streams

from labkit.course.lesson_run import LessonError, LessonRun, has_what_it_needs, normalised
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
            cell = LessonCell.from_parent(
                self,
                name=item.cell.get('id', item.name),
                cell_num=item.cell_num,
                cell=item.cell,
                options=item.options,
            )
            cell.index = index
            yield cell

    def setup(self) -> None:
        """Start the lesson's kernel, and read what nbval is to replace in outputs."""
        option = self.config.option
        named = self.nb.metadata.get('kernelspec', {}).get('name', 'python3')
        name = 'python3' if option.nbval_current_env else option.nbval_kernel_name or named
        self.run = LessonRun(
            self.path,
            cell_timeout_sec=option.nbval_cell_timeout,
            startup_timeout_sec=option.nbval_kernel_startup_timeout,
            kernel_name='python3' if name == 'python' else name,
        )
        self.setup_sanitize_files()
        self._measure(setup_coverage)

    def teardown(self) -> None:
        """End the kernel and all that it has started."""
        if self.run is not None:
            self._measure(teardown_coverage)
            self.run.close()

    def _measure(self, step: Callable[..., None]) -> None:
        """Begin or end to measure coverage, for `--cov` of pytest-cov."""
        if self.run is None or self.run.broken or not getattr(self.config.option, 'cov_source', 0):
            return
        # All that nbval asks of its kernel for this.
        run = SimpleNamespace(execute=self.run.execute_source)
        kernel = SimpleNamespace(language='python', kc=run, await_idle=lambda *_: None)
        step(self.config, kernel, None)


class OutputsDifferError(Exception):
    """What a cell shows is not what is stored; the text is the difference."""


class LessonCell(IPyNbCell):  # type: ignore[misc]
    """A code cell: it must run, and show what is stored."""

    index: int
    """Its position in the notebook, 0 for the first cell of any kind."""

    def runtest(self) -> None:
        """Run the cell, and those before it that have not run yet; compare its outputs."""
        if self.options['skip']:
            pytest.skip('nbval skips the cell')
        run = self.parent.run
        try:
            run.execute(self.index)
        except LessonError:
            # nbval then expects the lesson's further cells to fail, and reports only this one.
            self.parent.timed_out = run.timed_out or run.broken
            raise
        self.test_outputs = coalesce_streams(deepcopy(run.shown))
        # Where what it needs is not installed, it has said that, which no file stores.
        if not has_what_it_needs(self.cell):
            return
        # nbval leaves a cell alone that was never run, but not outputs without a run.
        if self.options['check'] or self.cell.execution_count is None:
            self._compare()

    def _compare(self) -> None:
        stored = self._comparable(coalesce_streams(deepcopy(self.cell.outputs)))
        now = self._comparable(deepcopy(self.test_outputs))
        if self.cell.execution_count is None:
            now, stored = [], stored and ['(outputs of a cell that has never run)', *stored]
        if stored != now:
            diff = difflib.unified_diff(stored, now, 'stored', 'now', lineterm='')
            raise OutputsDifferError('\n'.join(map(_visible, diff)))

    def _comparable(self, outputs: list[NotebookNode]) -> list[str]:
        """Return as lines what nbval compares of outputs, after its replacements and ours."""
        left_out, kept = self.parent.skip_compare, []
        for output in outputs:
            if output.get('name') in left_out:
                continue
            fields = output.get('data', output)
            for key in list(fields) if 'data' in output else ('text', 'ename', 'evalue'):
                if key in left_out:
                    fields.pop(key, None)
                elif key in fields and key not in PICTURES:
                    fields[key] = self.sanitize(fields[key])
            kept.append(output)
        # Stored outputs are in this form already, if `labkit record` has stored them.
        return _lines(normalised(kept, self.parent.run.folders()))

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
            said = [output[key] for key in ('ename', 'evalue') if key in output]
            parts = {'error': ': '.join(said)}
        else:
            parts = {f'{output.output_type}, {mime}': data for mime, data in output.data.items()}
        for title, content in sorted(parts.items()):
            if title.endswith(PICTURES):
                content = f'(a picture: {hashlib.sha256(content.encode()).hexdigest()[:16]})'
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
