from __future__ import annotations

from pathlib import Path

import jedi
import pytest

from labkit.errors import LabError
from labkit.exercises.exercise import Exercise, Solution, changed
from labkit.exercises.lesson import Lesson, NoSuchNameError, load
from labkit.exercises.quiz import Quiz

ROOT = Path(__file__).resolve().parent.parent.parent


@pytest.fixture
def lesson() -> Lesson:
    exercises = [
        Exercise(
            name=name,
            task=f'The task of {name}.',
            publishes={f'/{name}': 'std_msgs/msg/Int16'},
            judge=lambda probe: None,
            hints=['A hint.'],
            answer=Solution('pass', 'So.'),
        )
        for name in ('count_up', 'evens')
    ]
    quizzes = [Quiz('types'), Quiz('rates')]
    return Lesson('odds', '04_odds.ipynb', exercises=exercises, quizzes=quizzes, topics=['/x'])


def test_exercises_are_attributes_and_complete_by_tab(lesson: Lesson) -> None:
    assert lesson.count_up.name == 'count_up'
    assert dir(lesson) == ['count_up', 'evens', 'quiz']
    assert 'The task of evens.' in repr(lesson)


def test_wrong_name_is_answered_with_the_nearest(lesson: Lesson) -> None:
    with pytest.raises(
        NoSuchNameError, match=r"no exercise 'countup'[^?]*Did you mean 'count_up'"
    ):
        _ = lesson.countup
    with pytest.raises(NoSuchNameError, match='Its exercises: count_up, evens'):
        _ = lesson.xyz
    assert not hasattr(lesson, 'xyz') and not hasattr(lesson, '_ipython_display_')


def test_quiz_is_found_by_name(lesson: Lesson) -> None:
    assert lesson.quiz('rates').name == 'rates'
    with pytest.raises(LabError, match="Did you mean 'rates'"):
        lesson.quiz('rate')
    with pytest.raises(LabError, match="Its quizzes: 'types', 'rates'"):
        lesson.quiz()


def test_exercises_know_all_topics_of_the_lesson(lesson: Lesson) -> None:
    assert lesson.count_up.scope.known == {'/count_up', '/evens', '/x'}


def test_unknown_lesson_is_said() -> None:
    with pytest.raises(LabError, match="no lesson 'nothing_like_it'"):
        load('nothing_like_it')


def test_changed_refuses_what_is_not_there() -> None:
    assert changed('a = 1', ('1', '2')) == 'a = 2'
    with pytest.raises(ValueError, match="'3' is not in the code"):
        changed('a = 1', ('3', '2'))


@pytest.mark.parametrize(
    ('expression', 'names'),
    [
        ("lab.lesson('odds').count_up.", {'check', 'hint', 'solution'}),
        ("lab.lesson('odds').count_up.check().", {'outcome', 'passed', 'seen', 'why', 'todo'}),
        ("lab.lesson('odds').quiz('types').", {'answer'}),
    ],
)
def test_editor_completes_what_a_learner_writes(expression: str, names: set[str]) -> None:
    script = jedi.Script(f'import labkit as lab\n{expression}', project=jedi.Project(ROOT))
    assert names <= {completion.name for completion in script.complete()}
