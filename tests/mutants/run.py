"""Run mutants through the notebook of their lesson, in a real kernel, and keep the verdicts."""

from __future__ import annotations

import contextlib
import re
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mutants.generate import Mutant
from proof import MARK, PRESSES, Finding, copied, insert, press, reset_before

from labkit.course.lesson_run import LessonError, LessonRun
from labkit.exercises import Exercise, Lesson, Outcome

__all__ = ['Result', 'run_mutants']

# After so many mutants it is looked at whether the solution still passes in this kernel.
BATCH = 8
# A learner presses stop when a cell does not end; the starter of one exercise itself takes 20 s.
STOP_SEC = 30
CELL_TIMEOUT_SEC = 60
OWN_FAULT = 'The check itself has failed'


@dataclass(frozen=True)
class Result:
    """What came of a mutant.

    Attributes:
        mutant: The mutant.
        finding: The verdict; without an outcome, and with the reason, if there was none.
        spoils: What the solution got after it in the same kernel, if that was no PASS.
    """

    mutant: Mutant
    finding: Finding
    spoils: str = ''

    @property
    def passed(self) -> bool:
        """Tell whether it got PASS."""
        return self.finding.outcome is Outcome.PASS

    @property
    def is_specific(self) -> bool:
        """Tell whether the verdict has a reason of its own for this mutant.

        An ERROR shows the learner's own line. A FAIL has a Why. That nothing was attempted is
        not true, since all mutants attempt something.
        """
        text = self.finding.text
        if self.finding.outcome is Outcome.ERROR and OWN_FAULT not in text:
            return re.search(r'Cell In\[\d+\]|, line \d+', text) is not None
        return self.finding.outcome is Outcome.FAIL and ' Why: ' in text


def run_mutants(
    lesson: Lesson,
    exercise: Exercise,
    mutants: Sequence[Mutant],
    say: Callable[[Result], None],
) -> None:
    """Run the mutants of one exercise; tell `say` of each when its verdict is sure."""
    with _Bench(lesson, exercise) as bench:
        for start in range(0, len(mutants), BATCH):
            try:
                _run_batch(bench, mutants[start : start + BATCH], say)
            except LessonError as error:
                found = Finding(None, f'the lesson itself failed: {error}', 0.0)
                for mutant in mutants[start:]:
                    say(Result(mutant, found))
                return


def _run_batch(bench: _Bench, mutants: Sequence[Mutant], say: Callable[[Result], None]) -> None:
    """Run mutants in one kernel. What a spoilt kernel says is not believed, but asked again."""
    results = [Result(mutant, bench.try_code(mutant.code)) for mutant in mutants]
    spoilt = any(result.finding.outcome is None for result in results[:-1])
    control = Finding(None, 'not run', 0.0) if spoilt else bench.try_code(bench.solution)
    if control.outcome is not Outcome.PASS:
        bench.restart()
        if len(mutants) > 1:
            half = len(mutants) // 2
            _run_batch(bench, mutants[:half], say)
            _run_batch(bench, mutants[half:], say)
            return
        results = [Result(results[0].mutant, results[0].finding, control.text)]
    for result in results:
        say(result)


class _Bench:
    """A kernel in which a lesson has been worked through up to an exercise.

    Args:
        lesson: The lesson.
        exercise: The exercise.
    """

    def __init__(self, lesson: Lesson, exercise: Exercise) -> None:
        self._lesson, self._exercise = lesson, exercise
        self.solution = exercise.answer.code
        self._stack = contextlib.ExitStack()
        self._run: LessonRun | None = None

    def __enter__(self) -> _Bench:
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def restart(self) -> None:
        """End the kernel; the next code gets a new one."""
        self._stack.close()
        self._run = None

    def try_code(self, code: str) -> Finding:
        """Run code in the cell to edit, press the check, and return what it says.

        Raises:
            LessonError: A cell of the lesson itself has failed.
        """
        run = self._run or self._open()
        try:
            cells = run.notebook.cells
            cells[self._reset].source = '\n'.join(
                (
                    reset_before(self._exercise, code),
                    'kernel_tools.forget_names()',
                    f'kernel_tools.stop_next_cell_after({STOP_SEC})',
                )
            )
            run.execute(self._reset)
            cells[self._starter].source = code
            with contextlib.suppress(LessonError):  # it may raise
                run.execute(self._starter)
            return press(run, self._check, PRESSES)
        except LessonError as error:
            self.restart()
            return Finding(None, f'no verdict: {" ".join(str(error).split())}', 0.0)

    def _open(self) -> LessonRun:
        """Start a kernel, and work through the lesson up to the exercise, as it is in the file."""
        folder = Path(self._stack.enter_context(tempfile.TemporaryDirectory(prefix='mutants-')))
        run = LessonRun(copied(self._lesson, folder), cell_timeout_sec=CELL_TIMEOUT_SEC)
        self._stack.callback(run.close)
        cells = run.notebook.cells
        starters = {exercise.starter_id: exercise for exercise in self._lesson.exercises}
        for cell in cells:
            earlier = starters.get(cell.id)
            if earlier is self._exercise:
                break
            if earlier is not None:
                cell.source = earlier.answer.code
        ids = [cell.id for cell in cells]
        insert(run, ids.index(self._exercise.starter_id), MARK.format(str(folder)))
        self._starter = ids.index(self._exercise.starter_id) + 1
        self._check = ids.index(self._exercise.check_id) + 1
        self._reset = self._check + 1
        insert(run, self._reset, '')
        run.execute(self._check)
        self._run = run
        return run
