"""The state of a learner's lessons, and what comes next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import date, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any

from labkit import settings
from labkit.exercises.record.progress_store import number_of, text_of
from labkit.views.progress_picture import Item, Row

if TYPE_CHECKING:
    from labkit.exercises.lesson import Lesson

__all__ = ['days', 'days_in_a_row', 'entries', 'next_steps', 'onward', 'row_of']

Data = Mapping[str, Any]


def entries(lesson: Lesson, data: Data) -> list[dict[str, Any]]:
    """Return the state of each exercise and question of a lesson from the progress data."""
    known = data['lessons'].get(lesson.name, {})
    names = [('exercise', exercise.name) for exercise in lesson.exercises]
    names += [
        ('question', f'{quiz.name}.{number}')
        for quiz in lesson.quizzes
        for number in range(1, len(quiz) + 1)
    ]
    return [
        _entry(lesson.name, kind, name, known.get(f'{kind}s', {}).get(name, {}))
        for kind, name in names
    ]


def row_of(lesson: Lesson, data: Data, notebook: str = '') -> Row:
    """Return a lesson as a row of the progress picture.

    Args:
        lesson: The lesson.
        data: Data of the progress file.
        notebook: File name of the learner's copy; the published name if empty.
    """
    file = notebook or lesson.notebook
    cells = [exercise.task_id for exercise in lesson.exercises]
    cells += [quiz.cell_id for quiz in lesson.quizzes for _ in quiz.questions]
    items = [
        # A link to a cell as JupyterLab understands it.
        Item(entry['kind'], entry['name'], entry['state'], f'{file}#cell-id={cell_id}')
        for entry, cell_id in zip(entries(lesson, data), cells, strict=True)
    ]
    return Row(lesson.heading, items, file, lesson.teaches, lesson.minutes)


def next_steps(
    lesson: Lesson, solved: str, data: Data, lessons: list[Lesson]
) -> tuple[Row, list[tuple[str, str]]]:
    """Return the row of a lesson one exercise of which is solved, and what comes next.

    Returns:
        The lesson's row, and pairs of a text and a link: to the next exercise that is not done; if
        all are, to the quiz unless it is done, and to the next lesson.
    """
    row = row_of(lesson, data, _own_file())
    exercises = row.of_kind('exercise')
    position = [item.name for item in exercises].index(solved)
    for item in exercises[position + 1 :] + exercises[:position]:
        if item.state != 'done':
            return row, [(f'Next: {item.name}', item.href)]
    quiz = [('Next: the quiz', item.href) for item in _open_questions(row, warm_up=False)[:1]]
    return row, quiz + _next_lesson(lesson, lessons)


def onward(data: Data, lessons: list[Lesson]) -> list[tuple[str, str]]:
    """Return where to continue: what is open next, from the lesson of the last attempt on.

    A lesson that was not begun is read from its first line on. In one that was, exercises come
    before its quiz, and the warm-up is last: it looks back.
    """
    times = [
        max((max(e['passed_at'], e['first_try']) for e in entries(lesson, data)), default='')
        for lesson in lessons
    ]
    last = times.index(max(times)) if times else 0
    for lesson in lessons[last:] + lessons[:last]:
        row = row_of(lesson, data)
        if row.items and all(item.state == 'open' for item in row.items):
            return [(lesson.heading, lesson.notebook)]
        for item in row.of_kind('exercise'):
            if item.state != 'done':
                return [(f'{lesson.heading}, {item.name}', item.href)]
        for words, warm_up in (('quiz', False), ('warm-up', True)):
            for item in _open_questions(row, warm_up=warm_up):
                return [(f'{lesson.heading}, {words}', item.href)]
    return []


def days(data: Data) -> list[date]:
    """Return the days on which something was tried first or last, or solved; in local time."""
    times = {
        text_of(entry.get(key))
        for lesson in data['lessons'].values()
        for kind in ('exercises', 'questions')
        for entry in lesson.get(kind, {}).values()
        for key in ('first_try', 'last_try', 'passed_at')
    }
    return sorted({day for day in map(_local_day, times) if day is not None})


def days_in_a_row(worked: Sequence[date], today: date) -> int:
    """Return on how many days in a row a learner has worked, up to today or yesterday."""
    day, known = today, set(worked)
    if day not in known:
        day -= timedelta(days=1)
    count = 0
    while day - timedelta(days=count) in known:
        count += 1
    return count


def _local_day(time: str) -> date | None:
    try:
        return datetime.fromisoformat(time).astimezone().date()
    except (ValueError, OverflowError, OSError):
        return None  # not a time: somebody has changed the file


def _open_questions(row: Row, *, warm_up: bool) -> list[Item]:
    """Return the open questions of the warm-up, or of all other quizzes."""
    return [
        item
        for item in row.of_kind('question')
        if item.state != 'done' and item.name.startswith('warm_up.') == warm_up
    ]


def _next_lesson(lesson: Lesson, lessons: list[Lesson]) -> list[tuple[str, str]]:
    later = [other for other in lessons if other.notebook > lesson.notebook]
    return [(f'Next lesson: {other.heading}', other.notebook) for other in later[:1]]


def _own_file() -> str:
    """Return the file name of this kernel's notebook, `''` if it has none."""
    name = Path(settings.notebook_name()).name
    return name if name.endswith('.ipynb') else ''


def _entry(lesson: str, kind: str, name: str, entry: Mapping[str, Any]) -> dict[str, Any]:
    first, passed = (text_of(entry.get(name)) for name in ('first_try', 'passed_at'))
    tries = number_of(entry.get('tries'))
    return {
        'lesson': lesson,
        'kind': kind,
        'name': name,
        'state': 'done' if passed else 'tried' if tries else 'open',
        'tries': tries,
        'hints': number_of(entry.get('hints')),
        'solution_shown': 'yes' if entry.get('solution') is True else 'no',
        'first_try': first,
        'passed_at': passed,
    }
