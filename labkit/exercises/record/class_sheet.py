"""The sheet: a small document in a fixed format that a learner shares with a class.

It has the open lesson, and for each exercise, question and guess an extract of the progress file:
tries, hints, times, a sentence of the course on the last check, what was guessed. It does not
name the learner; its folder does. Readers validate all of it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime, timezone
from typing import Any

from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.mistakes import known_mistakes, said_by_the_course
from labkit.exercises.record.progress_store import GROUPS, number_of

__all__ = ['FILE_NAME', 'MOST_BYTES', 'Entry', 'Sheet', 'catalogue', 'read_sheet', 'sheet_text']

VERSION = 1
FILE_NAME = 'labkit-progress.json'
# Twice as much as a full sheet with long sentences.
MOST_BYTES = 100_000
MOST_TRIES = 100_000
LONGEST_SENTENCE = 600
MOST_OPTIONS = 4
_KEY = ('lesson', 'kind', 'name')
_GUESSES = ('before', 'after')
_TIMES = ('first_try', 'last_try', 'passed_at')
_OUTCOMES = ('', 'PASS', 'FAIL', 'ERROR')
_TIME = re.compile(r'\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\+00:00')

Key = tuple[str, str, str]
"""Lesson, kind (`'exercise'`, `'question'` or `'guess'`) and name."""


@dataclass(frozen=True)
class Entry:
    """The state of an exercise or a question.

    Attributes:
        tries: Number of checks or answers.
        hints: Number of hints shown.
        solution: Whether the solution was shown.
        last: Outcome of the last check: PASS, FAIL or ERROR; `''` if there was none.
        sentence: The course's sentence on the last outcome.
        first_try: Time of the first try.
        last_try: Time of the last try.
        passed_at: Time of the first pass.
        before: Which option was guessed, from 0, before the answer was known.
        after: Which one was guessed after it.
    """

    tries: int = 0
    hints: int = 0
    solution: bool = False
    last: str = ''
    sentence: str = ''
    first_try: datetime | None = None
    last_try: datetime | None = None
    passed_at: datetime | None = None
    before: int | None = None
    after: int | None = None


@dataclass(frozen=True)
class Sheet:
    """All that a learner shares.

    Attributes:
        written_at: Time of writing.
        lesson: The open lesson; `''` if none was.
        since: The time at which it was opened.
        entries: The exercises and questions that were begun.
    """

    written_at: datetime
    lesson: str = ''
    since: datetime | None = None
    entries: Mapping[Key, Entry] = field(default_factory=dict)


def catalogue() -> dict[Key, frozenset[str]]:
    """Return all exercises, questions and guesses, with the clauses of their tasks."""
    found: dict[Key, frozenset[str]] = {}
    for lesson in all_lessons():
        for exercise in lesson.exercises:
            clauses = frozenset(clause.text for clause in exercise.clauses)
            found[lesson.name, 'exercise', exercise.name] = clauses
        for quiz in lesson.quizzes:
            for number in range(1, len(quiz) + 1):
                found[lesson.name, 'question', f'{quiz.name}.{number}'] = frozenset()
        for guess in lesson.guesses:
            found[lesson.name, 'guess', guess.name] = frozenset()
    return found


# --- Writing -------------------------------------------------------------------------------------


def sheet_text(data: Mapping[str, Any], lesson: str, since: datetime | None) -> str:
    """Return the text of a sheet, with one line per exercise or question.

    Args:
        data: Data of the progress file.
        lesson: The open lesson; `''` if none is.
        since: The time at which it was opened.
    """
    known = catalogue()
    entries = []
    for (of_lesson, kind, name), clauses in known.items():
        group = data['lessons'].get(of_lesson, {}).get(GROUPS[kind], {})
        shared = _shared(group.get(name, {}), clauses)
        if shared:
            entries.append({'lesson': of_lesson, 'kind': kind, 'name': name, **shared})
    head = {
        'version': VERSION,
        'written_at': _now().isoformat(),
        'lesson': lesson if any(lesson == key[0] for key in known) else '',
        'since': since.isoformat(timespec='seconds') if since is not None else None,
    }
    lines = [json.dumps(head)[:-1] + ', "entries": [']
    lines += [json.dumps(entry) + ',' * (entry is not entries[-1]) for entry in entries]
    return '\n'.join([*lines, ']}', ''])


def _shared(entry: Mapping[str, Any], clauses: frozenset[str]) -> dict[str, Any]:
    """Return the shared part of an entry of the progress file."""
    last = entry.get('last')
    shared = {
        'tries': min(max(number_of(entry.get('tries')), 0), MOST_TRIES),
        'hints': min(max(number_of(entry.get('hints')), 0), MOST_TRIES),
        'solution': entry.get('solution') is True,
        'last': last if isinstance(last, str) and last in _OUTCOMES else '',
        'sentence': _sentence(entry, clauses),
        **{name: entry.get(name) for name in _TIMES if _is_time(entry.get(name))},
    }
    guessed = {name: entry.get(name) for name in _GUESSES if _is_option(entry.get(name))}
    return {**{name: value for name, value in shared.items() if value}, **guessed}


def _sentence(entry: Mapping[str, Any], clauses: frozenset[str]) -> str:
    # The course's own sentence: that of the verdict may contain names from the learner's code.
    found = known_mistakes().get(str(entry.get('mistake')))
    if found is not None and 0 < len(found.sentence) <= LONGEST_SENTENCE:
        return found.sentence
    clause = entry.get('clause')
    return clause if isinstance(clause, str) and clause in clauses else ''


def _now() -> datetime:
    return datetime.now(timezone.utc).replace(microsecond=0)


# --- Reading -------------------------------------------------------------------------------------


def read_sheet(content: bytes, known: Mapping[Key, frozenset[str]]) -> Sheet:
    """Parse and validate a sheet.

    Args:
        content: At most `MOST_BYTES`.
        known: See `catalogue`. Other entries, as of a newer course, are left out.

    Raises:
        ValueError: It is invalid. The message quotes nothing of it.
    """
    try:
        data = json.loads(content)
    except (ValueError, RecursionError):
        raise ValueError('no JSON') from None
    if not isinstance(data, dict):
        raise ValueError('no JSON object')
    if data.get('version') != VERSION or isinstance(data['version'], bool):
        raise ValueError('of another version of the course')
    written_at = _time(data, 'written_at')
    if written_at is None:
        raise ValueError('written_at is missing')
    lesson = _of_type(data, 'lesson', str, '')
    entries: dict[Key, Entry] = {}
    for item in _of_type(data, 'entries', list, []):
        if not isinstance(item, dict):
            raise ValueError('an entry is no object')
        of_lesson, kind, name = (_of_type(item, word, str, '') for word in _KEY)
        if (of_lesson, kind, name) in known:
            key = (of_lesson, kind, name)
            entries[key] = _entry(item, known[key])
    there = any(lesson == key[0] for key in known)
    return Sheet(written_at, lesson if there else '', _time(data, 'since'), entries)


def _entry(item: dict[str, Any], clauses: frozenset[str]) -> Entry:
    last = _of_type(item, 'last', str, '')
    if last not in _OUTCOMES:
        raise ValueError('last is no outcome')
    sentence = _of_type(item, 'sentence', str, '')
    if len(sentence) > LONGEST_SENTENCE:
        raise ValueError('sentence is too long')
    if sentence and sentence not in clauses and not said_by_the_course(sentence):
        sentence = ''  # of another version of the course, or made up by the sender
    return Entry(
        tries=_count(item, 'tries'),
        hints=_count(item, 'hints'),
        solution=_of_type(item, 'solution', bool, False),
        last=last,
        sentence=sentence,
        before=_option(item, 'before'),
        after=_option(item, 'after'),
        **{name: _time(item, name) for name in _TIMES},
    )


def _of_type(data: dict[str, Any], name: str, wanted: type, default: Any) -> Any:
    value = data.get(name, default)
    if type(value) is not wanted:
        raise ValueError(f'{name} is no {wanted.__name__}')
    return value


def _count(data: dict[str, Any], name: str) -> int:
    value: int = _of_type(data, name, int, 0)
    if not 0 <= value <= MOST_TRIES:
        raise ValueError(f'{name} is out of range')
    return value


def _option(data: dict[str, Any], name: str) -> int | None:
    value = data.get(name)
    if value is not None and not _is_option(value):
        raise ValueError(f'{name} is no option')
    return value


def _is_option(value: object) -> bool:
    return type(value) is int and 0 <= value < MOST_OPTIONS


def _time(data: dict[str, Any], name: str) -> datetime | None:
    value = data.get(name)
    if value is None:
        return None
    if not _is_time(value):
        raise ValueError(f'{name} is no time')
    return datetime.fromisoformat(value)


def _is_time(value: object) -> bool:
    if not isinstance(value, str) or not _TIME.fullmatch(value):
        return False
    try:
        datetime.fromisoformat(value)
    except ValueError:
        return False
    return True
