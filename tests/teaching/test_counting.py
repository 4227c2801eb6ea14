"""What the sheets of a class come to: numbers, who is stuck, what can hardly be true; tables."""

from __future__ import annotations

import csv
import io
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any

import pytest

from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.record.class_sheet import FILE_NAME, Entry, Sheet
from labkit.teaching.class_folder import Learner, Reading
from labkit.teaching.command import main
from labkit.teaching.counting import count, remarks
from labkit.teaching.tables import gradebook, table
from labkit.views.class_board import FailRow, text_form

NOW = datetime(2026, 5, 4, 10, 0, tzinfo=timezone.utc)
COUNT_UP, EVENS = ('odds', 'exercise', 'count_up'), ('odds', 'exercise', 'evens')
WHY = 'Two copies of the node run at once, and their messages mix on the topic.'


def ago(minutes: float) -> datetime:
    return NOW - timedelta(minutes=minutes)


def entry(first: float, last: float, outcome: str = 'FAIL', **more: Any) -> Entry:
    passed = ago(last) if outcome == 'PASS' else None
    data = {'tries': 3, 'last': outcome, 'passed_at': passed, **more}
    return Entry(first_try=ago(first), last_try=ago(last), **data)


def learner(name: str, written: float = 1, since: float = 60, **entries: Any) -> Learner:
    found = {('odds', 'exercise', exercise): known for exercise, known in entries.items()}
    return Learner(name, Sheet(ago(written), 'odds', ago(since), found))


def reading(*learners: Learner, **more: Any) -> Reading:
    return Reading(learners, **more)


def test_numbers_of_a_class() -> None:
    board = count(
        reading(
            learner('anna', count_up=entry(9, 8, 'PASS'), evens=entry(5, 4, sentence=WHY)),
            learner('ben', count_up=entry(9, 8, 'PASS'), evens=entry(5, 4, sentence=WHY)),
            learner('carl', written=25, count_up=entry(30, 25, 'ERROR')),
            learner('dora', evens=entry(5, 4, 'FAIL', passed_at=ago(4.5))),
            Learner('emil', trouble='too large'),
            silent=2,
        ),
        NOW,
    )
    assert (board.shared, board.at_work, board.stuck) == (5, 3, 0)
    (lesson,) = board.lessons
    assert (lesson.title, lesson.here) == ('04 Odd numbers', 3)
    assert ('count_up', 2, 1) in lesson.exercises and ('evens', 1, 2) in lesson.exercises
    # Who has passed once, and plays on, has not failed.
    assert board.fails == [
        FailRow(2, '04 Odd numbers, evens', WHY),
        FailRow(1, '04 Odd numbers, count_up', 'The code raises an error.'),
    ]
    assert board.note == 'From 1 of them came something that can not be used.'
    assert '2 more of the class share nothing.' in board.told
    text = text_form(board, names=False)
    assert text.startswith('Class: 5 share their progress, 3 at work, 0 stuck.')
    assert not any(name in text for name in ('anna', 'ben', 'carl', 'dora', 'emil'))
    assert f'2  04 Odd numbers, evens: {WHY}' in text
    assert 'have told. So are the names.' in text


@pytest.mark.parametrize(
    ('who', 'minutes'),
    [
        (learner('tries for 12 min', evens=entry(12, 1)), 12),
        (learner('for 9 min', evens=entry(9, 1)), None),
        (learner('has passed', evens=entry(30, 1, 'PASS')), None),
        (learner('passed before, plays on', evens=entry(30, 1, passed_at=ago(20))), None),
        (learner('is away', written=21, evens=entry(60, 21)), None),
        (learner('tried last week', since=3, evens=entry(10_000, 1)), None),
        (learner('tried last week, and for 15 min', since=15, evens=entry(10_000, 1)), 15),
        (learner('went on', count_up=entry(30, 20), evens=entry(5, 1)), None),
        (learner('has not begun'), None),
    ],
)
def test_who_is_stuck(who: Learner, minutes: int | None) -> None:
    board = count(reading(who), NOW)
    assert [row.stuck_min for row in board.learners] == [minutes]
    assert board.stuck == (minutes is not None)


def test_when_somebody_was_at_work() -> None:
    entries = {
        'count_up': entry(50, 40, 'PASS'),
        'evens': entry(30, 2),
        'long_ago': entry(500, 130, 'PASS'),
        'tried_before': entry(300, 100),
    }
    (row,) = count(reading(learner('anna', written=2, since=70, **entries)), NOW).learners
    assert (row.since_min, row.quiet_min) == (70, 2)
    assert row.marks == [(100, False), (50, False), (40, True), (30, False), (2, False)]


def test_who_is_stuck_comes_first() -> None:
    board = count(reading(learner('anna'), learner('zoe', evens=entry(12, 1))), NOW)
    assert [row.name for row in board.learners] == ['zoe', 'anna']
    text = text_form(board, names=True)
    exercises = sum(len(lesson.exercises) for lesson in all_lessons())
    stuck = f'zoe   04 Odd numbers, 0 of {exercises} passed, odds.evens FAIL, stuck for 12 min'
    assert stuck in text


MANY: dict[str, Any] = dict.fromkeys('abcd', entry(9, 8, 'PASS'))


@pytest.mark.parametrize(
    ('who', 'remark'),
    [
        (learner('honest', count_up=entry(9, 8, 'PASS'), evens=entry(5, 4)), []),
        (learner('fast clock', written=-1), []),
        (learner('x', written=-5), ['times in the future']),
        (learner('x', evens=entry(-9, -9)), ['times in the future']),
        (learner('x', evens=entry(9, 8, 'PASS', tries=0)), ['passed without a try']),
        (learner('x', evens=Entry(tries=2, last='PASS')), ['passed at no time']),
        (learner('x', evens=entry(5, 9)), ['times out of order']),
        (learner('x', evens=entry(5, 4, passed_at=ago(6))), ['times out of order']),
        (
            learner('x', 1, 60, **MANY),
            ['4 exercises passed within 10 s'],
        ),
        (learner('x', a=MANY['a'], b=MANY['b'], c=MANY['c']), []),
    ],
)
def test_what_can_hardly_be_true_is_remarked(who: Learner, remark: list[str]) -> None:
    assert who.sheet is not None
    assert list(remarks(who.sheet, NOW)) == remark


def test_any_time_can_be_counted_with() -> None:
    ends = [
        datetime(year, 1, 1, tzinfo=timezone.utc)
        for year in (datetime.min.year, datetime.max.year)
    ]
    for first in ends:
        for last in ends:
            odd = Entry(tries=1, last='FAIL', first_try=first, last_try=last, passed_at=None)
            sheet = Sheet(last, 'odds', first, {EVENS: odd})
            board = count(reading(Learner('x', sheet)), NOW)
            text_form(board, names=True)


def test_nobody_is_there() -> None:
    assert text_form(count(reading(), NOW), names=True) == (
        'Nobody shares their progress yet. Learners join with lab.join_class().'
    )


# --- Tables --------------------------------------------------------------------------------------


def rows(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def test_all_that_is_known_is_in_the_table() -> None:
    people = [
        learner('anna', evens=entry(5, 4, hints=2, solution=True)),
        Learner('ben', trouble='too large'),
    ]
    found = rows(table(people, NOW))
    (evens,) = [row for row in found if row['name'] == 'evens']
    assert evens['learner'] == 'anna' and evens['state'] == 'tried' and evens['tries'] == '3'
    assert evens['hints'] == '2' and evens['solution_shown'] == 'yes' and evens['last'] == 'FAIL'
    assert {row['state'] for row in found if row['lesson'] == 'chat'} == {'open'}
    (ben,) = [row for row in found if row['learner'] == 'ben']
    assert ben['remark'] == 'can not be used: too large'


def test_grade_book_has_a_line_a_learner_and_percents() -> None:
    people = [
        learner('anna', count_up=entry(9, 8, 'PASS'), evens=entry(5, 4)),
        learner('ben'),
        Learner('carl', trouble='too large'),
    ]
    anna, ben = rows(gradebook(people))
    assert anna['username'] == 'anna' and anna['04 Odd numbers'] == '20.0'
    assert set(ben.values()) == {'ben', '0.0'}
    # A lesson without exercises is nothing to be graded.
    assert len(anna) == 1 + len({key for key in anna if key[:2].isdigit()})


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / 'anna' / FILE_NAME
    path.parent.mkdir()
    path.write_text('{"version": 1, "written_at": "2026-01-01T00:00:00+00:00"}')
    (tmp_path / 'ben').mkdir()
    (tmp_path / 'ben' / FILE_NAME).write_text('x')
    assert main([str(tmp_path)]) == 0
    shown = capsys.readouterr().out
    assert shown.startswith('Class: 2 share') and 'anna' not in shown
    assert main([str(tmp_path), '--names']) == 0
    assert 'anna' in capsys.readouterr().out
    assert main([str(tmp_path), '--gradebook']) == 0
    written = capsys.readouterr()
    assert [row['username'] for row in rows(written.out)] == ['anna']
    assert written.err == 'ben: can not be used: no JSON\n'
    assert main([str(tmp_path), '--csv']) == 0
    questions = [quiz.questions for lesson in all_lessons() for quiz in lesson.quizzes]
    count = sum(len(lesson.exercises) + len(lesson.guesses) for lesson in all_lessons())
    count += sum(map(len, questions))
    # And a line for each whose file can't be used.
    assert len(rows(capsys.readouterr().out)) == count + 1


def test_what_a_class_has_guessed() -> None:
    (lesson,) = (found for found in all_lessons() if found.name == 'odds')
    (guess,) = lesson.guesses
    key = ('odds', 'guess', guess.name)

    def guesser(name: str, *chosen: int | None) -> Learner:
        before, after = chosen
        entries = {key: Entry(tries=1, before=before, after=after)}
        return Learner(name, Sheet(ago(1), 'odds', ago(60), entries))

    learners = guesser('anna', 0, 2), guesser('ben', 0, None), guesser('carl', 2, None)
    (row,) = count(reading(*learners, learner('dora')), NOW).guesses
    assert (row.ask, row.came) == (guess.ask, guess.came)
    assert [(before, after) for _, before, after in row.options] == [
        (2, 0),
        (0, 0),
        (1, 1),
        (0, 0),
    ]
    text = text_form(count(reading(*learners), NOW), names=False)
    assert f'      2   0  {guess.options[0]}\n' in text
    assert f'      1   1  {guess.options[2]} *\n' in text
    # A guess is no check, and a lesson that nobody works on shows none.
    assert 'anna' not in text and not count(reading(*learners), NOW).fails
    away = Learner('zoe', Sheet(ago(90), 'odds', ago(99), {key: Entry(before=0)}))
    assert not count(reading(away), NOW).guesses
    (line,) = (
        each for each in rows(table(learners[:1], NOW)) if each['kind'] == 'guess' and each['last']
    )
    assert line['last'] == 'a > c'
