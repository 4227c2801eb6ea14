"""A lesson with empty cells, and one with solutions, as a class sees them run."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from copy import deepcopy
from pathlib import Path
from typing import Any

import nbformat
import pytest
from proof import Finding, lessons, notebook_of, press

from labkit.course.lesson_run import LessonRun
from labkit.course.live_coding import blank, solved
from labkit.exercises import Lesson, Outcome

LESSONS = [lesson for lesson in lessons() if lesson.name != 'demo']

# The first test waits for its turn among the others.
pytestmark = [pytest.mark.timeout(1200), pytest.mark.slow('whole lessons, with solutions')]


@pytest.fixture(scope='module')
def runs(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[dict[str, Future[Any]]]:
    chosen = {item.name for item in request.session.items}
    lessons = [each for each in LESSONS if any(f'[{each.name}]' in name for name in chosen)]
    # Kernels mostly wait, so there may be more of them than cores.
    with ThreadPoolExecutor(max_workers=4) as pool:
        folders = [tmp_path_factory.mktemp(lesson.name) for lesson in lessons]
        yield {
            lesson.name: pool.submit(_run, lesson, folder)
            for lesson, folder in zip(lessons, folders, strict=True)
        }
        pool.shutdown(cancel_futures=True)


def _run(lesson: Lesson, folder: Path) -> dict[str, Finding]:
    """Run a lesson with empty cells, then with solutions; return what the checks say, by cell."""
    published = json.loads(notebook_of(lesson).read_text())
    # One kernel for both: what is empty leaves nothing behind.
    both = deepcopy(published)
    both['cells'] = blank(published)['cells']
    for cell in both['cells']:
        cell['id'] += '-blank'
    # As in JupyterLab: a solution may be a process of its own.
    both['metadata']['labkit'] = {'processes': True}
    both['cells'] += solved(published, lesson)['cells']
    path = folder / notebook_of(lesson).name
    nbformat.write(nbformat.from_dict(both), path)
    shutil.copytree(notebook_of(lesson).parent / 'images', folder / 'images')
    checks = {exercise.check_id for exercise in lesson.exercises}
    found: dict[str, Finding] = {}
    # Solutions of lesson 11 build, on machines that are busy: the limit only ends a hang.
    with LessonRun(path, cell_timeout_sec=300) as run:
        for index, cell in enumerate(both['cells']):
            if len(found) == 2 * len(checks):
                break  # what comes after the last exercise, nbval runs
            cell_id = cell['id'].removesuffix('-blank')
            if cell_id in checks:
                presses = 1 if cell_id != cell['id'] else 3
                found[cell['id']] = press(run, index, presses)
            else:
                run.execute(index)
    return found


@pytest.mark.parametrize('lesson', LESSONS, ids=lambda lesson: lesson.name)
def test_empty_cells_are_no_attempt_and_solutions_pass(
    lesson: Lesson, runs: dict[str, Future[dict[str, Finding]]]
) -> None:
    found = runs[lesson.name].result()
    assert len(found) == 2 * len(lesson.exercises)
    for exercise in lesson.exercises:
        empty = found[f'{exercise.check_id}-blank']
        assert empty.outcome is Outcome.NOT_ATTEMPTED, empty.text
        answer = found[exercise.check_id]
        assert answer.outcome is Outcome.PASS, answer.text
