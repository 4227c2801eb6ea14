"""The stop button at random moments of the checks of ten exercises, in real kernels."""

from __future__ import annotations

import os
import random
import time
from pathlib import Path

import pytest
from proof import MARK, copied, insert

from labkit.course.lesson_run import LessonError, LessonRun
from labkit.exercises.found_lessons import load

# By lesson: one kernel has those of a lesson.
EXERCISES = {
    'odds': ['ones', 'count_up', 'stay_within', 'evens'],
    'my_name_is': ['two_stages', 'own_process', 'third_stage'],
    'turtlebot': ['bot', 'square'],
    'services_and_parameters': ['metronome'],
}
# How often it is pressed in each exercise.
PRESSES = int(os.environ.get('LABKIT_TEST_STOPS', '2'))
PRESS = 'import kernel_tools\nkernel_tools.stop_next_cell_after({!r})'
LEFT = 'import kernel_tools\nkernel_tools.left_of_check()'
SAME = 'import kernel_tools\nkernel_tools.wait_until_left({!r})'


def said(run: LessonRun, source: str) -> str:
    """Run a line at the end of the notebook; return what it shows."""
    cell = insert(run, len(run.notebook.cells), source)
    try:
        run.execute(len(run.notebook.cells) - 1)
    finally:
        run.notebook.cells.pop()
    texts = [output['data']['text/plain'] for output in cell.outputs if 'data' in output]
    return texts[-1] if texts else ''


@pytest.mark.slow('it stops checks many times')
@pytest.mark.timeout(1200)
@pytest.mark.parametrize('name', EXERCISES)
def test_nothing_is_left_and_the_next_check_is_right(name: str, tmp_path: Path) -> None:
    lesson, draw, stopped = load(name), random.Random(name), 0
    with LessonRun(copied(lesson, tmp_path)) as run:
        said(run, MARK.format(str(tmp_path)))
        solutions = {exercise.starter_id: exercise for exercise in lesson.exercises}
        for index, cell in enumerate(run.notebook.cells):
            exercise = solutions.get(cell.id)
            if exercise is not None:
                cell.source = exercise.answer.code
            run.execute(index)
            if exercise is None or exercise.name not in EXERCISES[name]:
                continue
            check = f'lesson.{exercise.name}.forget()\nlesson.{exercise.name}.check()'
            began = time.monotonic()
            assert said(run, check).startswith('PASS: ')
            took = time.monotonic() - began
            before = said(run, LEFT)
            for number in range(PRESSES):
                # At once, which no check is too quick for, and then at any moment.
                moment = draw.uniform(0, took) if number else 0.0
                said(run, PRESS.format(moment))
                try:
                    said(run, check)
                except LessonError:
                    stopped += 1
                assert said(run, SAME.format(before)) == before, (exercise.name, moment)
                text = said(run, check)
                assert text.startswith('PASS: '), (exercise.name, moment, text)
    assert stopped
