"""Each clause of an exercise has wrong answers of all kinds, or says why there are none."""

from __future__ import annotations

from typing import Any

import kinds
import pytest

from labkit.exercises import Clause, Exercise
from labkit.exercises.found_lessons import all_lessons

EXERCISES = [
    pytest.param(exercise, id=f'{lesson.name}-{exercise.name}')
    for lesson in all_lessons()
    for exercise in lesson.exercises
]
CLAUSES = [
    pytest.param(exercise, clause, id=f'{lesson.name}-{exercise.name}-{number}')
    for lesson in all_lessons()
    for exercise in lesson.exercises
    for number, clause in enumerate(exercise.clauses, start=1)
]


@pytest.mark.parametrize(('exercise', 'clause'), CLAUSES)
def test_clause_has_an_answer_of_each_kind_or_a_reason(
    exercise: Exercise, clause: Clause[Any]
) -> None:
    troubles = {kind: kinds.trouble(exercise, clause, kind) for kind in kinds.KINDS}
    assert not any(troubles.values()), (clause.text, troubles)


@pytest.mark.parametrize('exercise', EXERCISES)
def test_table_has_no_clause_that_is_gone(exercise: Exercise) -> None:
    assert kinds.stale(exercise) == []


def test_each_table_is_that_of_a_lesson_with_these_exercises() -> None:
    names = {lesson.name: {each.name for each in lesson.exercises} for lesson in all_lessons()}
    tables = {path.stem for path in kinds.HERE.glob('*.yaml')} - {'usual'}
    assert tables <= {*names}
    assert all({*kinds.table_of(name)} <= names[name] for name in tables)


@pytest.mark.parametrize(
    ('said', 'wrong'),
    [
        ('Nobody knows.', 'too short'),
        ('no answer of this name', 'no answer'),
        ('program: no such program', 'program'),
        ('odds/count_up: ends at 19', 'odds/count_up'),
        ('', 'no field'),
    ],
)
def test_field_that_says_nothing_is_refused(
    said: str, wrong: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    lesson = next(each for each in all_lessons() if each.name == 'odds')
    clause = lesson.evens.clauses[0]
    monkeypatch.setattr(kinds, 'fields', lambda exercise, clause: {'A': said})
    assert wrong in kinds.trouble(lesson.evens, clause, 'A')
