"""A learner's place in the course, and what comes next."""

from __future__ import annotations

import json
from pathlib import Path
from types import ModuleType

import pytest
from by_hand import ByHand
from rclpy.node import Node

from labkit.exercises import lesson as lesson_module
from labkit.exercises.exercise import Exercise, Solution
from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.lesson import Lesson
from labkit.exercises.quiz.questions import Choice, right, wrong
from labkit.exercises.quiz.quiz import Quiz
from labkit.exercises.record.progress import progress
from labkit.exercises.record.progress_store import progress_store
from labkit.exercises.verdict import Verdict

ROOT = Path(__file__).resolve().parents[2]
QUESTION = Choice('Odd?', right('3', 'It is.'), wrong('4', 'It is not.'))


def exercise(name: str) -> Exercise:
    return Exercise(
        name=name,
        task='A task.',
        nodes=['/three'],
        stage=ByHand(lambda probe: 'It is there.'),
        hints=['First.'],
        answer=Solution('', '', 'So.'),
    )


@pytest.fixture(autouse=True)
def course(monkeypatch: pytest.MonkeyPatch) -> list[Lesson]:
    """Replace the lessons by a course of two."""
    names = ('one', 'two_odd', 'three')
    found = [
        Lesson(
            'odds',
            '04_odds.ipynb',
            title='Odd numbers',
            exercises=[exercise(name) for name in names],
            quizzes=[Quiz('types', QUESTION)],
        ),
        Lesson('chat', '06_chat.ipynb', title='Chat', exercises=[exercise('teller')]),
    ]
    monkeypatch.setattr(lesson_module, 'all_lessons', lambda: found)
    monkeypatch.setattr('labkit.exercises.record.progress.all_lessons', lambda: found)
    return found


def next_after(solved: Exercise) -> list[tuple[str, str]]:
    progress_store.note_check(solved.lesson, solved.name, 'PASS')
    assert solved.belongs_to is not None
    return solved.belongs_to.standing(solved)[1]


def test_next_is_the_exercise_that_is_not_done(course: list[Lesson]) -> None:
    odds = course[0]
    assert next_after(odds.two_odd) == [('Next: three', '04_odds.ipynb#cell-id=three-task')]
    # One that was left out comes after the last.
    assert next_after(odds.three) == [('Next: one', '04_odds.ipynb#cell-id=one-task')]
    assert next_after(odds.one) == [
        ('Next: the quiz', '04_odds.ipynb#cell-id=quiz'),
        ('Next lesson: 06 Chat', '06_chat.ipynb'),
    ]


def test_after_all_there_is_no_more(course: list[Lesson]) -> None:
    odds, chat = course
    labels = QUESTION.labels()
    odds.quiz().answer(1, 'ab'[labels.index('3')])
    for name in ('one', 'two_odd'):
        next_after(getattr(odds, name))
    assert next_after(odds.three) == [('Next lesson: 06 Chat', '06_chat.ipynb')]
    assert next_after(chat.teller) == []
    assert progress().onward == []


def test_notebook_of_another_name_leads_to_itself(
    course: list[Lesson], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv('JPY_SESSION_NAME', '/home/a/work/my odds.ipynb')
    assert next_after(course[0].one) == [('Next: two_odd', 'my odds.ipynb#cell-id=two-odd-task')]


def test_go_on_is_where_the_last_attempt_was(course: list[Lesson]) -> None:
    assert progress().onward == [('04 Odd numbers', '04_odds.ipynb')]
    progress_store.note_check('chat', 'teller', 'FAIL')
    assert progress().onward == [('06 Chat, teller', '06_chat.ipynb#cell-id=teller-task')]
    progress_store.note_check('chat', 'teller', 'PASS')
    # A lesson that was not begun is read from its first line on.
    assert progress().onward == [('04 Odd numbers', '04_odds.ipynb')]
    progress_store.note_check('odds', 'one', 'FAIL')
    assert progress().onward == [('04 Odd numbers, one', '04_odds.ipynb#cell-id=one-task')]


def test_go_on_leaves_no_quiz_out(course: list[Lesson]) -> None:
    for exercise in course[0].exercises:
        progress_store.note_check('odds', exercise.name, 'PASS')
    assert progress().onward == [('04 Odd numbers, quiz', '04_odds.ipynb#cell-id=quiz')]


def test_a_progress_file_with_values_of_other_types_is_shown() -> None:
    store = progress_store.store
    odd = {'tries': '7', 'hints': [], 'first_try': 5, 'passed_at': {'a': 1}}
    store.update(lambda data: data['lessons'].update(odds={'exercises': {'one': odd}}))
    assert 'Odd numbers' in repr(progress()) and progress()._repr_html_()


def test_links_lead_to_cells_that_there_are() -> None:
    lessons = all_lessons()
    assert len(lessons) == len(list((ROOT / 'notebooks').glob('*.ipynb')))
    for lesson in lessons:
        cells = json.loads((ROOT / 'notebooks' / lesson.notebook).read_text())['cells']
        ids = {cell['id'] for cell in cells}
        assert {one.task_id for one in lesson.exercises} <= ids
        assert {quiz.cell_id for quiz in lesson.quizzes} <= ids
        assert len({quiz.cell_id for quiz in lesson.quizzes}) == len(lesson.quizzes)


def test_title_and_what_is_taught_are_those_of_notebook_and_readme() -> None:
    readme = (ROOT / 'README.md').read_text()
    for lesson in all_lessons():
        cells = json.loads((ROOT / 'notebooks' / lesson.notebook).read_text())['cells']
        assert cells[0]['source'][0].strip() == f'# {lesson.title}'
        link = f'[{lesson.heading}](notebooks/{lesson.notebook})'
        assert f'| {link} | {lesson.teaches} | {lesson.minutes} |' in readme


def test_verdict_says_where_the_learner_is(course: list[Lesson], lab: ModuleType) -> None:
    node = lab.spin(Node('three'))
    verdict = course[0].one.check()
    lab.remove(node)
    assert isinstance(verdict, Verdict)
    # In text it is short, as it was.
    assert repr(verdict).splitlines() == ['PASS: one', '  It is there.']
    html = verdict._repr_html_()
    assert 'href="04_odds.ipynb#cell-id=two-odd-task"' in html
    assert '1 of 3 exercises of this lesson' in html
    assert (
        verdict.with_note('Kept.').passed and 'Kept.' in verdict.with_note('Kept.')._repr_html_()
    )
