"""The nodes of a lesson's own cells are never the learner's, also when those cells run again."""

from __future__ import annotations

from pathlib import Path

import pytest
from proof import copied, press

from labkit.course.lesson_run import LessonRun
from labkit.exercises import Outcome
from labkit.exercises.found_lessons import load

pytestmark = pytest.mark.slow('each demonstration, in kernels')

# Cells that make nodes like those that an exercise asks for.
DEMONSTRATIONS = {
    'start_here': ['first-node'],
    'talker_listener': ['talker-run', 'listener-class', 'two-talkers', 'not-spun', 'too-early'],
}
AGAIN = {'talker_listener': ['talker-run', 'listener-class', 'two-talkers']}


@pytest.mark.parametrize('name', DEMONSTRATIONS)
def test_a_demonstration_is_no_attempt(name: str, tmp_path: Path) -> None:
    lesson = load(name)
    with LessonRun(copied(lesson, tmp_path)) as run:
        ids = [cell.id for cell in run.notebook.cells]
        first = ids.index(lesson.exercises[0].starter_id)
        for index in range(first):
            run.execute(index)
        for cell_id in (*DEMONSTRATIONS[name], *AGAIN.get(name, ())):
            run.execute(ids.index(cell_id))
        for exercise in lesson.exercises:
            found = press(run, ids.index(exercise.check_id), presses=1)
            assert found.outcome is Outcome.NOT_ATTEMPTED, found.text
