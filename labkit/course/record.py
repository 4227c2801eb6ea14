"""Run lessons and store their outputs: the only way in which stored outputs are made."""

# nbformat has no annotations.
# mypy: disable-error-code="no-untyped-call"

from __future__ import annotations

import json
import re
import sys
import time
from collections.abc import Sequence
from copy import deepcopy
from pathlib import Path

import nbformat
from nbformat import NotebookNode

from labkit.course.lesson_run import LessonError, LessonRun
from labkit.errors import LabError
from labkit.files import write_atomically

__all__ = ['as_stored', 'lesson_paths', 'record']

LESSONS_DIR = Path(__file__).resolve().parents[2] / 'notebooks'
KERNELSPEC = {'display_name': 'Python 3 (ipykernel)', 'language': 'python', 'name': 'python3'}
# Of the metadata only what the course itself gives is kept: editors add their own, with times.
CELL_METADATA = ('jupyter', 'labkit', 'tags')


def lesson_paths(names: Sequence[str] = (), *, folder: Path = LESSONS_DIR) -> list[Path]:
    """Return the notebooks of the lessons with these names, in their order; all if none is given.

    Args:
        names: `'02'`, `'02_talker_listener'` or the file's name.
        folder: Where the lessons are.

    Raises:
        LabError: There is no such lesson.
    """
    paths = {path.stem: path for path in sorted(folder.glob('[0-9][0-9]_*.ipynb'))}
    chosen: set[str] = set()
    for name in names or paths:
        stem = Path(name).name.removesuffix('.ipynb')
        found = {other for other in paths if stem in (other, other[:2])}
        if not found:
            raise LabError(
                f'Expected the name of a lesson, but it is {name!r}.',
                todo=f'The lessons are: {", ".join(paths) or "none"}.',
            )
        chosen |= found
    return [path for stem, path in paths.items() if stem in chosen]


def record(names: Sequence[str] = (), *, folder: Path = LESSONS_DIR) -> int:
    """Run lessons and store their outputs. The file of a lesson that fails stays as it was.

    Args:
        names: Lessons, as `lesson_paths` takes them; all of them if empty.
        folder: Where the lessons are.

    Returns:
        Exit code: 0, or 1 if a lesson failed.

    Raises:
        LabError: There is no such lesson.
    """
    exit_code = 0
    for path in lesson_paths(names, folder=folder):
        print(f'{path.stem} ... ', end='', flush=True)
        start = time.monotonic()
        try:
            done = _record_lesson(path)
        except LessonError as error:
            exit_code = 1
            print(f'failed\n{_report(error)}\nThe file is left as it was.', flush=True)
        else:
            print(f'{done} in {time.monotonic() - start:.1f} s', flush=True)
    return exit_code


def _report(error: LessonError) -> str:
    place = f'Cell {error.cell_id!r}: ' if error.cell_id else ''
    text = f'{place}{error.message}\n{error.traceback}'.rstrip()
    return text if sys.stdout.isatty() else re.sub(r'\x1b\[[\d;]*m', '', text)


def _record_lesson(path: Path) -> str:
    """Run one lesson, store it, and return what was done."""
    before = path.read_bytes()
    with LessonRun(path) as run:
        for index in range(len(run.notebook.cells)):
            run.execute(index)
    _keep_unsteady(run.notebook, nbformat.reads(before.decode(), as_version=4))
    after = as_stored(run.notebook)
    if path.read_bytes() != before:
        raise LessonError('The notebook was changed while it ran; record it again.')
    number = len(run.notebook.cells)
    if after == before:
        return f'{number} cells unchanged'
    write_atomically(path, after)
    return f'{number} cells recorded'


def _keep_unsteady(notebook: NotebookNode, before: NotebookNode) -> None:
    """Keep the stored outputs of a cell that is not compared if only numbers in them are new.

    They are measured values, other ones each time: the file need not change for that.
    """
    for cell, old in zip(notebook.cells, before.cells, strict=True):
        if 'nbval-ignore-output' in cell.metadata.get('tags', ()):
            forms = [
                json.dumps(outputs, sort_keys=True) for outputs in (cell.outputs, old.outputs)
            ]
            if len({re.sub(r'\d+', '0', form) for form in forms}) == 1:
                cell.outputs = old.outputs


def as_stored(notebook: NotebookNode) -> bytes:
    """Return the content of a notebook's file: the same bytes for the same cells and outputs."""
    notebook = deepcopy(notebook)
    for cell in notebook.cells:
        kept = {key: value for key, value in cell.metadata.items() if key in CELL_METADATA}
        cell.metadata = NotebookNode(kept)
    metadata = NotebookNode(kernelspec=KERNELSPEC, language_info={'name': 'python'})
    if 'labkit' in notebook.metadata:
        metadata['labkit'] = notebook.metadata['labkit']
    notebook.metadata = metadata
    notebook.nbformat_minor = 5
    return f'{nbformat.v4.writes(notebook).rstrip()}\n'.encode()
