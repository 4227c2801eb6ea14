"""The tables of answers fit to the solutions, and every file beside them belongs to a row."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import SimpleNamespace

import cases
import pytest
from cases import answers_of, changes_of, right, slug
from proof import lessons

from labkit.exercises.mistakes import known_mistakes

ROOT = Path(__file__).resolve().parents[2]


def test_every_program_is_an_answer() -> None:
    named = set(cases.HERE.glob('*.py'))
    for lesson in lessons():
        for exercise in lesson.exercises:
            home = cases.HERE / lesson.name / exercise.name
            named.add(home.with_suffix('.py'))
            for answer in answers_of(exercise):
                named |= {home / f'{slug(answer.name)}{suffix}' for suffix in cases.SUFFIXES}
            solution = exercise.answer
            named.add(Path(solution.module).parent / 'solutions' / solution.name)
    written = {path for path in cases.HERE.rglob('*.*py') if path.suffix in cases.SUFFIXES}
    written |= set((ROOT / 'labkit/lessons').glob('*/solutions/*.*'))
    assert written - named == set()


def test_a_change_is_of_the_exercise_after_which_its_mistake_is_named() -> None:
    tried = {
        each.id for lesson in lessons() for one in lesson.exercises for each in changes_of(one)
    }
    told = {each.id for each in known_mistakes().values() if each.change}
    assert told - tried == set()


@pytest.mark.parametrize(
    ('rows', 'complaint'),
    [
        ([right('other', ('2', '3'))], "other: '2' is not in the code"),
        ([right('same')], 'same: no changes, no file'),
        ([right('twin', ('1', '2')), right('twin', ('1', '3'))], 'have one name'),
    ],
)
def test_a_table_that_does_not_fit_is_refused(
    rows: list[cases.Row], complaint: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = SimpleNamespace(ANSWERS=rows)
    monkeypatch.setattr(importlib, 'import_module', lambda name: table)
    answer = SimpleNamespace(code='a = 1\n', name='x.py')
    exercise = SimpleNamespace(lesson='odds', name='x', answer=answer, once=False)
    with pytest.raises(ValueError, match=complaint):
        answers_of.__wrapped__(exercise)
