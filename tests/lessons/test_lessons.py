"""What every lesson's exercises and quizzes have, and what the notebook has for them."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import demo
import nbformat
import pytest
from cases import answers_of
from cases.generic import KINDS
from proof import lessons, notebook_of

from labkit.exercises import Choice, Exercise, Lesson, Number, Outcome, Several, Word
from labkit.exercises.found_lessons import lesson_names, load
from labkit.exercises.quiz.questions import Question

# How many answers of each kind an exercise has, beside the shown solution.
WRONG, STYLES = 8, 4
ROOT = Path(__file__).resolve().parent.parent.parent
LESSONS = lessons()
EXERCISES = [
    pytest.param(lesson, exercise, id=f'{lesson.name}-{exercise.name}')
    for lesson in LESSONS
    for exercise in lesson.exercises
]
QUESTIONS = [
    pytest.param(question, id=f'{lesson.name}-{quiz.name}-{number}')
    for lesson in LESSONS
    for quiz in lesson.quizzes
    for number, question in enumerate(quiz.questions, start=1)
]


def cells_of(lesson: Lesson) -> dict[str, str]:
    notebook = nbformat.read(notebook_of(lesson), as_version=4)
    return {cell.id: cell.source for cell in notebook.cells}


@pytest.mark.parametrize('name', lesson_names())
def test_lesson_loads(name: str) -> None:
    assert load(name).name == name


@pytest.mark.parametrize('lesson', LESSONS, ids=lambda lesson: lesson.name)
def test_lesson_is_named_as_its_notebook(lesson: Lesson) -> None:
    assert lesson.notebook.removesuffix('.ipynb').lstrip('0123456789_') == lesson.name


@pytest.mark.parametrize(('lesson', 'exercise'), EXERCISES)
def test_notebook_has_the_cells_of_an_exercise(lesson: Lesson, exercise: Exercise) -> None:
    cells = cells_of(lesson)
    ids = list(cells)
    # What is written in an editor, and started in a terminal, has no place in a cell.
    assert '...' in cells[exercise.starter_id] or exercise.answer.name.endswith('.sh')
    assert f'lesson.{exercise.name}.check()' in cells[exercise.check_id]
    assert ids.index(exercise.starter_id) < ids.index(exercise.check_id)


@pytest.mark.parametrize(('lesson', 'exercise'), EXERCISES)
def test_exercise_is_complete(lesson: Lesson, exercise: Exercise) -> None:
    assert exercise.name.isidentifier()
    assert exercise.task and exercise.answer.reason
    assert len(exercise.hints) >= 2
    assert all(topic.startswith('/') for topic in exercise.scope.topics)
    assert all(node.startswith('/') for node in (*exercise.scope.given, *exercise.nodes))
    wrong = [answer for answer in answers_of(exercise) if answer.outcome is not Outcome.PASS]
    # What is generated may get another sentence in each exercise.
    assert all(len(answer.says) >= 8 for answer in wrong if answer.name not in KINDS)
    if lesson is not demo.LESSON:
        assert exercise.clauses
        assert len(wrong) >= WRONG
        assert len(answers_of(exercise)) - len(wrong) >= STYLES


@pytest.mark.parametrize(('lesson', 'exercise'), EXERCISES)
def test_task_in_the_notebook_says_what_is_checked_and_nothing_else(
    lesson: Lesson, exercise: Exercise
) -> None:
    task = cells_of(lesson)[exercise.starter_id.replace('-starter', '-task')]
    bullets = re.findall(r'^- (.*)$', task, flags=re.MULTILINE)
    assert bullets == [f'{clause.text}' for clause in exercise.clauses]


@pytest.mark.parametrize(
    'lesson',
    [lesson for lesson in LESSONS if lesson.notebook[:2].isdigit() and lesson.notebook >= '02'],
    ids=lambda lesson: lesson.name,
)
def test_three_questions_about_earlier_lessons_open_a_lesson(lesson: Lesson) -> None:
    assert list(cells_of(lesson))[1:4] == ['setup', 'warm-up-read', 'warm-up']
    first = lesson.quizzes[0]
    assert (first.name, first.cell_id, len(first)) == ('warm_up', 'warm-up', 3)
    others = [
        q.text
        for other in LESSONS
        for quiz in other.quizzes
        if quiz is not first
        for q in quiz.questions
    ]
    assert not {question.text for question in first.questions} & {*others}


@pytest.mark.parametrize('question', QUESTIONS)
def test_every_answer_of_a_question_is_explained(question: Question) -> None:
    assert question.text.strip()
    if isinstance(question, (Choice, Several)):
        assert all(option.why.strip() for option in question.options)
        rights = [option for option in question.options if option.is_right]
        assert len(rights) == 1 if isinstance(question, Choice) else rights
        assert len(rights) < len(question.options)
        assert len({option.text for option in question.options}) == len(question.options)
    else:
        assert isinstance(question, (Number, Word))
        assert question.why.strip() and question.otherwise.strip()
        assert all(why.strip() for why in question.wrong.values())


def test_lessons_load_without_ros() -> None:
    code = (
        'import json, sys\n'
        'from labkit.exercises.found_lessons import all_lessons\n'
        'names = [lesson.name for lesson in all_lessons()]\n'
        "loaded = {name.partition('.')[0] for name in sys.modules}\n"
        "print(json.dumps([names, sorted(loaded & {'rclpy', 'std_msgs', 'ipywidgets'})]))"
    )
    done = subprocess.run(
        [sys.executable, '-c', code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    names, loaded = json.loads(done.stdout)
    assert sorted(names) == lesson_names()
    assert loaded == []
