"""Evaluating the sheets of a class: who is where, who is stuck, what fails, what is unlikely."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import datetime, timedelta

from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.lesson import Lesson
from labkit.exercises.record.class_sheet import Entry, Sheet
from labkit.teaching.class_folder import Learner, Reading
from labkit.views.class_board import Board, FailRow, GuessRow, LearnerRow, LessonRow

__all__ = ['count', 'remarks']

# Not at work after this time without news.
AWAY = timedelta(minutes=20)
# Stuck after this time with one exercise.
STUCK = timedelta(minutes=10)
# Tolerance between clocks.
CLOCKS = timedelta(minutes=2)
# So many exercises in so short a time are passed by a program.
MANY, SHORT = 4, timedelta(seconds=10)
# How far back it is shown when a learner was at work.
STRIP = timedelta(hours=2)
MAX_FAILS = 5
_RAISED = 'The code raises an error.'
_NO_WORDS = 'It is not what the task asks for.'


def count(reading: Reading, now: datetime) -> Board:
    """Return the state of a class.

    Args:
        reading: What the learners have sent.
        now: The time on the teacher's computer.
    """
    lessons = all_lessons()
    titles = {lesson.name: lesson.heading for lesson in lessons}
    certain = reading.certain and any(learner.certain for learner in reading.learners)
    rows = [_row(learner, titles, now, certain) for learner in reading.learners]
    sheets = [learner.sheet for learner in reading.learners if learner.sheet is not None]
    working = [sheet for sheet in sheets if _at_work(sheet, now)]
    broken = sum(learner.sheet is None for learner in reading.learners)
    unread = f'From {broken} of them came something that can not be used.' if broken else ''
    return Board(
        shared=len(reading.learners),
        at_work=len(working),
        stuck=sum(row.stuck_min is not None for row in rows),
        lessons=[row for lesson in lessons for row in _lesson_rows(lesson, sheets, working)],
        fails=_fails(sheets, titles),
        guesses=[row for lesson in lessons for row in _guess_rows(lesson, sheets, working)],
        learners=sorted(rows, key=_order),
        exercise_count=sum(len(lesson.exercises) for lesson in lessons),
        certain=certain,
        silent=reading.silent,
        note=' '.join(filter(None, [unread, reading.note])),
    )


def remarks(sheet: Sheet, now: datetime) -> Iterator[str]:
    """Return what is implausible about a sheet.

    A forged sheet can't be told from a true one: anybody who programs can write any. These are the
    obvious cases.

    Args:
        sheet: What a learner has sent.
        now: The time on the teacher's computer.
    """
    times = [sheet.written_at, sheet.since]
    entries = sheet.entries.values()
    for entry in entries:
        times += [entry.first_try, entry.last_try, entry.passed_at]
    if any(time is not None and time > now + CLOCKS for time in times):
        yield 'times in the future'
    if any(entry.passed_at is not None and not entry.tries for entry in entries):
        yield 'passed without a try'
    if any(entry.last == 'PASS' and entry.passed_at is None for entry in entries):
        yield 'passed at no time'
    if any(_is_out_of_order(entry) for entry in entries):
        yield 'times out of order'
    passed = sorted(
        entry.passed_at
        for (_, kind, _), entry in sheet.entries.items()
        if kind == 'exercise' and entry.passed_at is not None
    )
    if any(b - a < SHORT for a, b in zip(passed, passed[MANY - 1 :], strict=False)):
        yield f'{MANY} exercises passed within {SHORT.seconds} s'


def _is_out_of_order(entry: Entry) -> bool:
    times = [t for t in (entry.first_try, entry.passed_at, entry.last_try) if t is not None]
    return times != sorted(times)


# --- A learner -----------------------------------------------------------------------------------


def _row(
    learner: Learner, titles: dict[str, str], now: datetime, names_are_given: bool
) -> LearnerRow:
    sheet = learner.sheet
    unsure = ['others can write there'] if names_are_given and not learner.certain else []
    if sheet is None:
        return LearnerRow(
            learner.name, remark=', '.join([f'can not be used: {learner.trouble}', *unsure])
        )
    lesson, name, entry = _newest(sheet)
    stuck = _stuck_since(sheet, entry, now)
    return LearnerRow(
        learner.name,
        lesson=titles.get(sheet.lesson, ''),
        done=sum(
            entry.passed_at is not None
            for (_, kind, _), entry in sheet.entries.items()
            if kind == 'exercise'
        ),
        exercise=f'{lesson}.{name}' if name else '',
        last=entry.last,
        stuck_min=None if stuck is None else _minutes(now - stuck),
        quiet_min=_minutes(now - sheet.written_at),
        since_min=None if sheet.since is None else _minutes(now - sheet.since),
        marks=_marks(sheet, now),
        remark=', '.join([*remarks(sheet, now), *unsure]),
    )


def _marks(sheet: Sheet, now: datetime) -> list[tuple[int, bool]]:
    """Return when something was tried or passed: minutes ago and whether passed, oldest first."""
    found = {
        (_minutes(now - time), time == entry.passed_at)
        for entry in sheet.entries.values()
        for time in (entry.first_try, entry.last_try, entry.passed_at)
        if time is not None and -CLOCKS <= now - time <= STRIP
    }
    return sorted(found, reverse=True)


def _order(row: LearnerRow) -> tuple[float, str]:
    """Sort those who have been stuck longest first."""
    return (1.0 if row.stuck_min is None else -row.stuck_min, row.name)


def _newest(sheet: Sheet) -> tuple[str, str, Entry]:
    """Return the exercise that was checked last, with its lesson."""
    checked = [
        (entry.last_try, lesson, name, entry)
        for (lesson, kind, name), entry in sheet.entries.items()
        if kind == 'exercise' and entry.last_try is not None
    ]
    if not checked:
        return '', '', Entry()
    _, lesson, name, entry = max(checked, key=lambda item: item[0])
    return lesson, name, entry


def _at_work(sheet: Sheet, now: datetime) -> bool:
    return now - sheet.written_at <= AWAY


def _stuck_since(sheet: Sheet, entry: Entry, now: datetime) -> datetime | None:
    """Return since when a learner has been stuck at an exercise, None if not, or not for long."""
    if entry.first_try is None or entry.passed_at is not None or not _at_work(sheet, now):
        return None
    # Attempts of earlier sessions do not count: only since the notebook was opened.
    since = max(entry.first_try, sheet.since or entry.first_try)
    return since if now - since >= STUCK else None


def _minutes(time: timedelta) -> int:
    return max(int(time.total_seconds() // 60), 0)


# --- All of them ---------------------------------------------------------------------------------


def _lesson_rows(
    lesson: Lesson, sheets: Sequence[Sheet], working: Sequence[Sheet]
) -> Iterator[LessonRow]:
    here = sum(sheet.lesson == lesson.name for sheet in working)
    exercises = []
    for exercise in lesson.exercises:
        key = (lesson.name, 'exercise', exercise.name)
        entries = [sheet.entries[key] for sheet in sheets if key in sheet.entries]
        passed = sum(entry.passed_at is not None for entry in entries)
        tried = sum(entry.passed_at is None and entry.tries > 0 for entry in entries)
        exercises.append((exercise.name, passed, tried))
    if here or any(passed or tried for _, passed, tried in exercises):
        yield LessonRow(lesson.heading, here, exercises)


def _guess_rows(
    lesson: Lesson, sheets: Sequence[Sheet], working: Sequence[Sheet]
) -> Iterator[GuessRow]:
    """Return what was guessed in a lesson that somebody works on."""
    if not any(sheet.lesson == lesson.name for sheet in working):
        return
    for guess in lesson.guesses:
        entries = [sheet.entries.get((lesson.name, 'guess', guess.name)) for sheet in sheets]
        before, after = (
            [sum(each == index for each in chosen) for index in range(len(guess.options))]
            for chosen in (
                [entry.before for entry in entries if entry is not None],
                [entry.after for entry in entries if entry is not None],
            )
        )
        if sum(before) or sum(after):
            options = list(zip(guess.options, before, after, strict=True))
            yield GuessRow(lesson.heading, guess.ask, options, guess.came)


def _fails(sheets: Sequence[Sheet], titles: dict[str, str]) -> list[FailRow]:
    found: Counter[tuple[str, str]] = Counter()
    for sheet in sheets:
        for (lesson, _, name), entry in sheet.entries.items():
            if entry.last in ('FAIL', 'ERROR') and entry.passed_at is None:
                words = entry.sentence or (_RAISED if entry.last == 'ERROR' else _NO_WORDS)
                found[f'{titles[lesson]}, {name}', words] += 1
    most = sorted(found.items(), key=lambda item: (-item[1], item[0]))[:MAX_FAILS]
    return [FailRow(number, exercise, words) for (exercise, words), number in most]
