"""Drive every exercise of a lesson through its own notebook, in a real kernel, in all states."""

from __future__ import annotations

import contextlib
import os
import shutil
import time
from collections.abc import Collection
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path

import built_once
import demo
import nbformat
from cases import Answer, answers_of
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell

from labkit.course.lesson_run import LessonError, LessonRun
from labkit.exercises import Exercise, Lesson, Outcome
from labkit.exercises.found_lessons import lesson_names, load

HERE = Path(__file__).resolve().parent
NOTEBOOKS = HERE.parent.parent / 'notebooks'
# A check may ask to be pressed again when a process has just been started.
PRESSES = 3
# Eight kernels work side by side. It is there to end a hang, s.
HANG_SEC = 300
# A state gets the same draws each time, so that its verdict can be had again. With another number,
# checks draw something else.
DRAW = os.environ.get('PROOF_DRAW', '1')
# Cells of the kernel: before an answer is tried, and between two of them.
# (A lesson may go to another folder, so the tools are looked for beside the notebook.)
MARK = 'import sys\nsys.path.insert(0, {!r})\nimport kernel_tools\nkernel_tools.mark()'
_RESET = (
    'import random\nimport kernel_tools\nkernel_tools.clean()\nlesson.{name}.forget()\n'
    'random.seed({seed!r})'
)


def lessons() -> list[Lesson]:
    """Return the lessons that can be loaded; one that cannot has a test of its own to say so."""
    found = [demo.LESSON]
    for name in lesson_names():
        with contextlib.suppress(Exception):
            found.append(load(name))
    return found


def notebook_of(lesson: Lesson) -> Path:
    """Return the notebook of a lesson."""
    return (HERE / 'demo' if lesson is demo.LESSON else NOTEBOOKS) / lesson.notebook


@dataclass(frozen=True)
class Finding:
    """What came of a state.

    Attributes:
        outcome: The outcome, None if the cell gave no verdict.
        text: The verdict as text, on one line.
        seconds: How long the check took.
        told: Silent faults that labkit has told under the cells of the state.
    """

    outcome: Outcome | None
    text: str
    seconds: float
    told: str = ''


def reset_before(exercise: Exercise, name: str) -> str:
    """Return a cell that takes away what an answer has left, before the one of a name."""
    return _RESET.format(name=exercise.name, seed=f'{exercise.name} {name} {DRAW}')


def can_run(exercise: Exercise) -> bool:
    """Tell whether what an exercise needs is here: MuJoCo has no wheel for Python 3.10."""
    return find_spec('mujoco') is not None or not getattr(exercise.stage, 'physics', False)


def states_of(exercise: Exercise) -> list[Answer]:
    """Return the states of an exercise, the shown solution last, so that it stays."""
    name = exercise.name
    return [
        Answer(name, 'untouched', None, Outcome.NOT_ATTEMPTED),
        *answers_of(exercise),
        Answer(name, 'solution', exercise.answer.code, Outcome.PASS),
        # The same nodes once more: a check can be pressed twice.
        Answer(name, 'solution, pressed again', '', Outcome.PASS),
    ]


def copied(lesson: Lesson, folder: Path) -> Path:
    """Copy the notebook of a lesson, and what its kernel needs, into a folder; return its path."""
    notebook = notebook_of(lesson)
    if lesson is demo.LESSON:
        shutil.copytree(HERE / 'demo', folder / 'demo')
        shutil.copy(HERE.parent / 'by_hand.py', folder)
    shutil.copy(HERE / 'kernel_tools.py', folder)
    built_once.install(folder / '.colcon')
    content = nbformat.read(notebook, as_version=4)
    if any(state.process for exercise in lesson.exercises for state in states_of(exercise)):
        content.metadata['labkit'] = {'processes': True}
    nbformat.write(content, folder / notebook.name)
    return folder / notebook.name


def prove(
    lesson: Lesson, folder: Path, wanted: Collection[tuple[str, str]]
) -> dict[tuple[str, str], Finding]:
    """Work through a lesson; return what came of each exercise and state, see `Proof`."""
    return Proof(lesson, folder).run(wanted)


class Proof:
    """One lesson in one kernel.

    Args:
        lesson: The lesson.
        folder: An empty folder to work in.
    """

    def __init__(self, lesson: Lesson, folder: Path) -> None:
        self.lesson = lesson
        self._path = copied(lesson, folder)
        self.findings: dict[tuple[str, str], Finding] = {}

    def run(self, wanted: Collection[tuple[str, str]]) -> dict[tuple[str, str], Finding]:
        """Work through the notebook; return what came of each exercise and state.

        Args:
            wanted: The exercises and states to go through. The exercises before the last of them
                are solved anyway.

        Raises:
            LessonError: A cell of the lesson itself has failed.
        """
        left = {name for name, _ in wanted}
        with LessonRun(self._path, cell_timeout_sec=HANG_SEC) as run:
            done = 0
            by_starter = {exercise.starter_id: exercise for exercise in self.lesson.exercises}
            # What comes after the last of them proves nothing here: nbval runs all cells.
            while left:
                exercise = by_starter.get(run.notebook.cells[done].id)
                if exercise is None:
                    run.execute(done)
                    done += 1
                else:
                    done = self._prove(run, done, exercise, wanted)
                    left.discard(exercise.name)
        return self.findings

    def _prove(
        self,
        run: LessonRun,
        starter: int,
        exercise: Exercise,
        wanted: Collection[tuple[str, str]],
    ) -> int:
        """Put one exercise through its states; return the index of the cell after it."""
        cells = run.notebook.cells
        insert(run, starter, MARK.format(str(self._path.parent)))
        starter += 1
        check = [cell.id for cell in cells].index(exercise.check_id)
        for index in range(starter - 1, check):
            run.execute(index)
        reset = insert(run, check + 1, '')
        self.findings[exercise.name, 'untouched'] = press(run, check, presses=1)
        for state in states_of(exercise)[1:]:
            if (exercise.name, state.name) not in wanted and state.name != 'solution':
                continue
            if state.code:
                reset.source = reset_before(exercise, state.name)
                run.execute(check + 1)
                script = f'import kernel_tools\nkernel_tools.run_script({state.code!r})'
                cells[starter].source = script if state.process else state.code
                # A wrong answer may raise in the notebook.
                with contextlib.suppress(*() if state.process else (LessonError,)):
                    run.execute(starter)
            found = press(run, check)
            told = _told(cells[starter]) * bool(state.code) + _told(cells[check])
            self.findings[exercise.name, state.name] = replace(found, told=told)
        reset.source = ''
        run.execute(check + 1)
        # A buffer keeps what an answer has said of frames that do not move.
        for index, cell in enumerate(cells[:starter]):
            if 'TransformListener(memory' in cell.source and cell.cell_type == 'code':
                run.execute(index)
        return check + 2


def press(run: LessonRun, check: int, presses: int = PRESSES) -> Finding:
    """Run the cell of a check, again if it asks for it; return what came of it.

    Args:
        run: The run.
        check: Index of the cell.
        presses: How often it is run at most.

    Raises:
        LessonError: The cell has failed.
    """
    for _ in range(presses):
        start = time.monotonic()
        cell = run.execute(check)
        if any('CHECKING: ' in str(output) for output in cell.outputs):
            insert(run, check + 1, 'await _')
            cell = run.execute(check + 1)
            del run.notebook.cells[check + 1]
        found = _finding(cell, time.monotonic() - start)
        if 'un this cell again' not in found.text:
            break
    return found


def _told(cell: NotebookNode) -> str:
    """Return the silent faults that are told under a cell."""
    texts = [output.get('data', {}).get('text/plain', '') for output in cell.outputs]
    return '\n'.join(text for text in texts if text.startswith('⚠'))


def _finding(cell: NotebookNode, seconds: float) -> Finding:
    text = '\n'.join(
        output['data'].get('text/plain', '')
        for output in cell.outputs
        if output.output_type == 'execute_result'
    )
    outcome = next((o for o in Outcome if text.startswith(f'{o.value}: ')), None)
    return Finding(outcome, ' '.join(text.split()), seconds)


def insert(run: LessonRun, index: int, source: str) -> NotebookNode:
    """Put a cell of code into the notebook of a run; return it."""
    cell = new_code_cell(source)
    run.notebook.cells.insert(index, cell)
    return cell
