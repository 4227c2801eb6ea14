from __future__ import annotations

from pathlib import Path

import jedi
import pytest
from by_hand import ByHand

from labkit.errors import LabError
from labkit.exercises.exercise import Exercise, Solution
from labkit.exercises.found_lessons import load
from labkit.exercises.lesson import Lesson, NoSuchNameError
from labkit.exercises.quiz.quiz import Quiz

ROOT = Path(__file__).resolve().parent.parent.parent


def exercise(name: str) -> Exercise:
    return Exercise(
        name=name,
        task=f'The task of {name}.',
        publishes={f'/{name}': 'std_msgs/msg/Int16'},
        stage=ByHand(lambda probe: None),
        hints=['A hint.'],
        answer=Solution('', '', 'So.'),
    )


@pytest.fixture
def lesson() -> Lesson:
    exercises = [exercise(name) for name in ('count_up', 'evens')]
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


def test_an_exercise_of_another_lesson_is_found_there(lesson: Lesson) -> None:
    with pytest.raises(NoSuchNameError, match='It is in lesson 02 Talker and listener'):
        _ = lesson.ears


def test_quiz_is_found_by_name(lesson: Lesson) -> None:
    assert lesson.quiz('rates').name == 'rates'
    with pytest.raises(LabError, match="Did you mean 'rates'"):
        lesson.quiz('rate')
    with pytest.raises(LabError, match="Its quizzes: 'types', 'rates'"):
        lesson.quiz()


@pytest.mark.parametrize('name', ['title', 'quiz', 'notebook', 'heading', 'standing', '_hidden'])
def test_an_exercise_that_could_not_be_reached_is_refused(name: str) -> None:
    with pytest.raises(LabError, match=f"An exercise of lesson 'odds' can not be called '{name}'"):
        Lesson('odds', '04_odds.ipynb', exercises=[exercise(name)])


def test_two_of_one_name_are_refused() -> None:
    with pytest.raises(LabError, match="Lesson 'odds' has two exercises called 'evens'"):
        Lesson('odds', '04_odds.ipynb', exercises=[exercise('evens'), exercise('evens')])
    with pytest.raises(LabError, match="Lesson 'odds' has two quizzes called 'types'"):
        Lesson('odds', '04_odds.ipynb', quizzes=[Quiz('types'), Quiz('types')])


def test_exercises_know_all_topics_of_the_lesson(lesson: Lesson) -> None:
    assert lesson.count_up.scope.known == {'/count_up', '/evens', '/x'}


def test_unknown_lesson_is_said() -> None:
    with pytest.raises(LabError, match="no lesson 'nothing_like_it'"):
        load('nothing_like_it')


def test_solution_is_shown_without_the_import_that_the_notebook_has(tmp_path: Path) -> None:
    (tmp_path / 'solutions').mkdir()
    text = 'import x\n\nimport labkit as lab\n\nx = 1\n'
    (tmp_path / 'solutions' / 'ones.py').write_text(text)
    solution = Solution(str(tmp_path / 'odds.py'), 'ones.py', 'So.')
    assert solution.code == 'import x\n\nx = 1\n'
    assert solution.changed(('1', '2')).code == 'import x\n\nx = 2\n'


@pytest.mark.slow('jedi reads all of labkit')
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
