"""Run lessons and store their outputs: the only way stored outputs are made."""

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

from labkit.course.lesson_run import LessonError, LessonRun, has_what_it_needs, nbval_options
from labkit.errors import LabError
from labkit.files import write_atomically

__all__ = ['as_stored', 'lesson_paths', 'record', 'with_bullets', 'write_tasks']

LESSONS_DIR = Path(__file__).resolve().parents[2] / 'notebooks'
KERNELSPEC = {'display_name': 'Python 3 (ipykernel)', 'language': 'python', 'name': 'python3'}
# Metadata of the course; editors add their own, with times.
CELL_METADATA = ('jupyter', 'labkit', 'tags')
_BULLET = re.compile(r'^- .*(?:\n  .*)*(?:\n|\Z)', re.MULTILINE)


def lesson_paths(names: Sequence[str] = (), *, folder: Path = LESSONS_DIR) -> list[Path]:
    """Return the notebooks of the lessons with these names, in order; all if none are given.

    Args:
        names: `'02'`, `'02_talker_listener'` or the file's name. The path of a notebook in another
            folder is itself.
        folder: Folder of the lessons.

    Raises:
        LabError: There is no such lesson.
    """
    paths = {path.stem: path for path in sorted(folder.glob('[0-9][0-9]_*.ipynb'))}
    copies = [path for path in map(Path, names) if _is_elsewhere(path, folder)]
    names = [name for name in names if Path(name) not in copies]
    chosen: set[str] = set()
    for name in names or (() if copies else paths):
        stem = Path(name).name.removesuffix('.ipynb')
        found = {other for other in paths if stem in (other, other[:2])}
        if not found:
            raise LabError(
                f'Expected the name of a lesson, but it is {name!r}.',
                todo=f'The lessons are: {", ".join(paths) or "none"}.',
            )
        chosen |= found
    return [*(path for stem, path in paths.items() if stem in chosen), *copies]


def _is_elsewhere(path: Path, folder: Path) -> bool:
    here = path.suffix == '.ipynb' and path.is_file()
    return here and path.resolve().parent != folder.resolve()


def record(names: Sequence[str] = (), *, folder: Path = LESSONS_DIR) -> int:
    """Run lessons and store their outputs. If a lesson fails, its file is left unchanged.

    Args:
        names: Lessons, as for `lesson_paths`; all if empty.
        folder: Folder of the lessons.

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
    """Run and store one lesson; return a summary."""
    before = path.read_bytes()
    with LessonRun(path) as run:
        write_tasks(run.notebook, path.name)
        for cell in run.notebook.cells:
            if not has_what_it_needs(cell):
                message = f'it needs {cell.metadata["labkit"]["needs"]}, which is not installed'
                raise LessonError(message, cell_id=str(cell.get('id', '')))
        for index in range(len(run.notebook.cells)):
            _check_raised(run.execute(index))
    _keep_measurements(run.notebook, nbformat.reads(before.decode(), as_version=4))
    after = as_stored(run.notebook)
    if path.read_bytes() != before:
        raise LessonError('The notebook was changed while it ran; record it again.')
    number = len(run.notebook.cells)
    if after == before:
        return f'{number} cells unchanged'
    write_atomically(path, after)
    return f'{number} cells recorded'


def _check_raised(cell: NotebookNode) -> None:
    """Raise if a cell did not fail, though it says that it does."""
    options = nbval_options(cell)
    raised = any(output.output_type == 'error' for output in cell.get('outputs', ()))
    if options.get('check_exception') and not options.get('skip') and not raised:
        message = 'it is tagged raises-exception, but nothing was raised'
        raise LessonError(message, cell_id=str(cell.get('id', '')))


def write_tasks(notebook: NotebookNode, name: str) -> None:
    """Write the bullets of each exercise's clauses into the cell with its task.

    The prose before and after the bullets stays. A notebook without a lesson is left unchanged.

    Args:
        notebook: The notebook.
        name: Its file name.
    """
    from labkit.exercises.found_lessons import all_lessons

    lesson = next((each for each in all_lessons() if each.notebook == name), None)
    tasks = {exercise.task_id: exercise for exercise in lesson.exercises} if lesson else {}
    for cell in notebook.cells:
        if cell.id in tasks:
            cell.source = with_bullets(cell.source, [c.text for c in tasks[cell.id].clauses])


def with_bullets(source: str, texts: Sequence[str]) -> str:
    """Return the source of a cell with its bullets replaced by these texts."""
    bullets = list(_BULLET.finditer(source))
    if not bullets:
        return '\n\n'.join([source, '\n'.join(f'- {text}' for text in texts)])
    parts, end = [], 0
    for number, bullet in enumerate(bullets):
        last = number == len(bullets) - 1
        own = texts[number:] if last else texts[number : number + 1]
        parts += [source[end : bullet.start()], *(f'- {text}\n' for text in own)]
        end = bullet.end()
    return ''.join([*parts, source[end:]]).rstrip()


def _keep_measurements(notebook: NotebookNode, before: NotebookNode) -> None:
    """Keep the stored outputs of a cell that is not compared, if only numbers in them differ.

    These are measurements, different each time: the file need not change for that.
    """
    for cell, old in zip(notebook.cells, before.cells, strict=True):
        if not nbval_options(cell).get('check', True):
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
