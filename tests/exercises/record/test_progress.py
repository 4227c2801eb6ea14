from __future__ import annotations

import csv
import io
from datetime import date
from pathlib import Path

import pytest
from by_hand import ByHand

from labkit.exercises import lesson as lesson_module
from labkit.exercises.exercise import Exercise
from labkit.exercises.found_lessons import load
from labkit.exercises.lesson import Lesson
from labkit.exercises.lesson_progress import days, days_in_a_row
from labkit.exercises.quiz.questions import Choice, right, wrong
from labkit.exercises.quiz.quiz import Quiz
from labkit.exercises.record import progress as progress_module
from labkit.exercises.record.progress import main, progress
from labkit.exercises.record.progress_store import progress_store
from tests.conftest import Kernel


def exercise(name: str) -> Exercise:
    return Exercise(
        name=name,
        task='A task.',
        publishes={'/odds': 'std_msgs/msg/Int16'},
        stage=ByHand(lambda probe: None),
        hints=['First.', 'Second.'],
        answer=load('odds').ones.answer,
    )


@pytest.fixture(autouse=True)
def lesson(monkeypatch: pytest.MonkeyPatch) -> Lesson:
    quiz = Quiz('types', Choice('Odd?', right('3', 'It is.'), wrong('4', 'It is not.')))
    found = Lesson(
        'odds', '04_odds.ipynb', exercises=[exercise('one'), exercise('two')], quizzes=[quiz]
    )
    for module in (progress_module, lesson_module):
        monkeypatch.setattr(module, 'all_lessons', lambda: [found])
    return found


def test_picture_and_text_say_what_is_done_and_tried(lesson: Lesson) -> None:
    progress_store.note_check('odds', 'one', 'PASS')
    progress_store.note_check('odds', 'two', 'FAIL')
    shown = progress()
    assert '04 odds  1 of 2 exercises, 0 of 1 question' in repr(shown)
    assert '    done   one' in repr(shown) and '    tried  two' in repr(shown)
    html = shown._repr_html_()
    assert '<strong>50 %</strong> of the exercises: 1 of 2 exercises, 0 of 1 question' in html
    assert 'exercise one: done' in html and '0 of 1</td>' in html


def test_csv_has_a_line_for_everything(lesson: Lesson, capsys: pytest.CaptureFixture[str]) -> None:
    lesson.one.hint()
    lesson.one.hint()
    lesson.one.solution()
    lesson.quiz().answer(1, 'a')
    progress_store.note_check('odds', 'two', 'PASS')
    assert main(['--csv']) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert [row['name'] for row in rows] == ['one', 'two', 'types.1']
    assert rows[0]['hints'] == '2' and rows[0]['solution_shown'] == 'yes'
    assert rows[1]['state'] == 'done' and rows[1]['passed_at']
    assert rows[2]['kind'] == 'question' and rows[2]['tries'] == '1'


def test_command_shows_text(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    assert capsys.readouterr().out.startswith('Progress: 0 of 2 exercises, 0 of 1 question done')


def test_damaged_file_is_said_from_then_on(home: Path) -> None:
    home.mkdir()
    (home / 'progress.json').write_text('{')
    assert 'was damaged' in repr(progress())
    assert 'progress-damaged-1.json' in repr(progress())
    assert 'progress-damaged-1.json' in progress()._repr_html_()


def test_hints_come_in_steps_and_then_end(lesson: Lesson) -> None:
    assert 'HINT 1 of 2' in repr(lesson.one.hint())
    assert 'Second.' in repr(lesson.one.hint())
    assert 'lesson.one.solution()' in repr(lesson.one.hint())
    assert 'First.' in repr(lesson.one.hint(1))


def test_days_in_a_row_end_today_or_yesterday(lesson: Lesson) -> None:
    def worked(*numbers: int) -> list[date]:
        return [date(2026, 3, number) for number in numbers]

    today = date(2026, 3, 9)
    assert days_in_a_row([], today) == 0
    assert days_in_a_row(worked(7, 8, 9), today) == 3
    assert days_in_a_row(worked(5, 7, 8), today) == 2
    assert days_in_a_row(worked(5, 6, 7), today) == 0
    data = {'lessons': {'odds': {'exercises': {'one': {'last_try': 'yesterday', 'tries': 1}}}}}
    assert days(data) == []
    progress_store.note_check('odds', 'one', 'PASS')
    assert days(progress_store.store.read()[0]) == list(progress().days) != []


def test_certificate_is_there_when_all_exercises_are_solved(lesson: Lesson) -> None:
    progress_store.note_check('odds', 'one', 'PASS')
    assert 'Certificate' not in progress()._repr_html_()
    progress_store.note_check('odds', 'two', 'PASS')
    assert 'Certificate: all exercises' in progress()._repr_html_()


def test_progress_that_is_shown_follows_what_is_solved(kernel: Kernel) -> None:
    shown = kernel.run('import labkit as lab\nlab.progress()', cell_id='progress')
    assert 'tried' not in shown.text
    kernel.run(
        'from labkit.exercises.record.progress_store import progress_store\n'
        "progress_store.note_check('odds', 'ones', 'FAIL')"
    )
    kernel.wait_for_output(shown.msg_id, 'tried  ones')
