"""The sheet that a learner shares: its contents, and what readers refuse."""

from __future__ import annotations

import json
from datetime import datetime, timezone
from typing import Any

import pytest

from labkit.exercises.common_mistakes import TWO_COPIES
from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.mistakes import known_mistakes
from labkit.exercises.record.class_sheet import (
    MOST_BYTES,
    Entry,
    catalogue,
    read_sheet,
    sheet_text,
)
from labkit.exercises.record.progress_file import Store
from labkit.exercises.record.progress_store import ProgressStore

SINCE = datetime(2026, 1, 2, 3, 4, 5, tzinfo=timezone.utc)
TIME = '2026-01-02T03:04:05+00:00'
WHY = TWO_COPIES.sentence
KEY = ('odds', 'exercise', 'count_up')


@pytest.fixture
def store(tmp_path: Any) -> ProgressStore:
    return ProgressStore(Store(tmp_path))


def text_of(store: ProgressStore) -> str:
    return sheet_text(store.store.read()[0], 'odds', SINCE)


def test_what_is_sent_is_read(store: ProgressStore) -> None:
    store.note_check('odds', 'count_up', 'FAIL', clause='whatever', mistake=TWO_COPIES.id)
    store.note_hint('odds', 'count_up', 2)
    store.note_solution('odds', 'count_up')
    store.note_check('odds', 'evens', 'PASS')
    sheet = read_sheet(text_of(store).encode(), catalogue())
    assert (sheet.lesson, sheet.since) == ('odds', SINCE)
    entry = sheet.entries[KEY]
    assert (entry.tries, entry.hints, entry.solution, entry.last) == (1, 2, True, 'FAIL')
    assert entry.sentence == WHY and entry.passed_at is None
    assert entry.first_try == entry.last_try is not None
    passed = [key for key, entry in sheet.entries.items() if entry.passed_at]
    assert passed == [('odds', 'exercise', 'evens')]


def test_nothing_of_a_learners_own_is_sent(store: ProgressStore) -> None:
    quiz = next(lesson.quizzes[0] for lesson in all_lessons() if lesson.name == 'odds')
    store.note_check('odds', 'count_up', 'ERROR', why='my_password is not defined. Oh dear, oh.')
    store.note_answer('odds', quiz.name, 1, False, given='my_password')
    store.note_check('my_password', 'count_up', 'PASS')
    text = text_of(store)
    assert 'my_password' not in text and 'Oh dear' not in text
    words = {name for item in json.loads(text)['entries'] for name in item}
    assert words == {'lesson', 'kind', 'name', 'tries', 'first_try', 'last_try', 'last'}


def test_a_clause_is_said_where_there_is_no_reason(store: ProgressStore) -> None:
    (clause, *_) = catalogue()[KEY]
    store.note_check('odds', 'count_up', 'FAIL', clause=clause)
    store.note_check('odds', 'evens', 'FAIL', clause='say this to the class')
    entries = read_sheet(text_of(store).encode(), catalogue()).entries
    assert entries[KEY].sentence == clause
    assert entries['odds', 'exercise', 'evens'].sentence == ''


@pytest.mark.slow('goes through the whole course')
def test_all_of_the_course_fits(store: ProgressStore) -> None:
    longest = max(known_mistakes().values(), key=lambda mistake: len(mistake.sentence))
    for lesson, kind, name in catalogue():
        if kind == 'exercise':
            store.note_check(lesson, name, 'PASS')
            store.note_check(lesson, name, 'FAIL', mistake=longest.id)
            store.note_hint(lesson, name, 3)
            store.note_solution(lesson, name)
        elif kind == 'guess':
            store.note_guess(lesson, name, 1)
            store.note_told(lesson, name)
            store.note_guess(lesson, name, 2)
        else:
            quiz, _, number = name.rpartition('.')
            store.note_answer(lesson, quiz, int(number), True, given='x' * 1000)
    text = text_of(store)
    assert len(text.encode()) < MOST_BYTES
    entries = read_sheet(text.encode(), catalogue()).entries
    assert entries.keys() == catalogue().keys()
    guessed = {(e.before, e.after) for (_, kind, _), e in entries.items() if kind == 'guess'}
    assert guessed == {(1, 2)}


def test_a_progress_file_that_was_changed_by_hand_makes_no_bad_sheet() -> None:
    odd = {'tries': -3, 'hints': 10**30, 'last': ['x'], 'first_try': 'now', 'passed_at': 7}
    for entry in (odd, {'tries': 'x', 'why': 3, 'clause': None, 'solution': 'yes', 'last': 'OK'}):
        data = {'lessons': {'odds': {'exercises': {'count_up': entry}}}}
        read_sheet(sheet_text(data, 'no lesson', None).encode(), catalogue())


# --- What others may send ------------------------------------------------------------------------


def sent(**entry: Any) -> bytes:
    item = {'lesson': 'odds', 'kind': 'exercise', 'name': 'count_up', **entry}
    return json.dumps({'version': 1, 'written_at': TIME, 'entries': [item]}).encode()


@pytest.mark.parametrize(
    ('content', 'trouble'),
    [
        (b'', 'no JSON'),
        (b'\xff\xfe{}', 'no JSON'),
        (b'[' * MOST_BYTES, 'no JSON'),
        (b'{"a":' * (MOST_BYTES // 5), 'no JSON'),
        (b'[]', 'no JSON object'),
        (b'null', 'no JSON object'),
        (b'{}', 'of another version of the course'),
        (b'{"version": true}', 'of another version of the course'),
        (b'{"version": 2}', 'of another version of the course'),
        (b'{"version": 1}', 'written_at is missing'),
        (b'{"version": 1, "written_at": 5}', 'written_at is no time'),
        (b'{"version": 1, "written_at": "2026-13-45T99:00:00+00:00"}', 'written_at is no time'),
        (f'{{"version": 1, "written_at": "{TIME}", "lesson": 1}}'.encode(), 'lesson is no str'),
        (
            f'{{"version": 1, "written_at": "{TIME}", "entries": {{}}}}'.encode(),
            'entries is no list',
        ),
        (
            f'{{"version": 1, "written_at": "{TIME}", "entries": [1]}}'.encode(),
            'an entry is no object',
        ),
        (sent(tries='1'), 'tries is no int'),
        (sent(tries=True), 'tries is no int'),
        (sent(tries=1.5), 'tries is no int'),
        (sent(tries=float('nan')), 'tries is no int'),
        (sent(tries=-1), 'tries is out of range'),
        (sent(tries=10**12), 'tries is out of range'),
        (sent(solution=1), 'solution is no bool'),
        (sent(last='GREAT'), 'last is no outcome'),
        (sent(sentence=['x']), 'sentence is no str'),
        (sent(sentence='x' * 5000), 'sentence is too long'),
        (sent(passed_at='yesterday'), 'passed_at is no time'),
        (sent(passed_at=TIME[:-6]), 'passed_at is no time'),
        (sent(passed_at=0), 'passed_at is no time'),
        (sent(lesson=['odds']), 'lesson is no str'),
    ],
)
def test_what_has_another_form_is_refused_as_a_whole(content: bytes, trouble: str) -> None:
    with pytest.raises(ValueError) as refused:
        read_sheet(content, catalogue())
    assert str(refused.value) == trouble


def test_what_the_course_does_not_know_is_left_out() -> None:
    html = '<img src=x onerror=alert(1)>'
    known = catalogue()
    assert read_sheet(sent(name=html), known).entries == {}
    assert read_sheet(sent(lesson=html, more=[html]), known).entries == {}
    assert read_sheet(sent(sentence='My teacher is stupid.'), known).entries[KEY] == Entry()
    assert read_sheet(sent(sentence=WHY), known).entries[KEY].sentence == WHY
    data = {'version': 1, 'written_at': TIME, 'lesson': html, 'entries': []}
    assert read_sheet(json.dumps(data).encode(), known).lesson == ''
    many = [{'lesson': 'odds', 'kind': 'exercise', 'name': str(n)} for n in range(100_000)]
    data['entries'] = many
    assert read_sheet(json.dumps(data).encode(), known).entries == {}
