"""Where a learner is: what is done of a lesson, and what comes next."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from labkit import settings
from labkit.exercises.attempts import number_of
from labkit.views.progress_picture import Item, Row

if TYPE_CHECKING:
    from labkit.exercises.exercise import Exercise
    from labkit.exercises.lesson import Lesson

__all__ = ['after', 'entries', 'onward', 'row_of']

Data = Mapping[str, Any]


def entries(lesson: Lesson, data: Data) -> list[dict[str, Any]]:
    """Return what is known of each exercise and question of a lesson, those not begun included.

    Args:
        lesson: The lesson.
        data: What the progress file holds.
    """
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
    """Return a lesson as progress shows it.

    Args:
        lesson: The lesson.
        data: What the progress file holds.
        notebook: File name of the learner's copy; as it was published if empty.
    """
    file = notebook or lesson.notebook
    cells = [exercise.task_id for exercise in lesson.exercises]
    cells += [quiz.cell_id for quiz in lesson.quizzes for _ in quiz.questions]
    items = [
        Item(entry['kind'], entry['name'], entry['state'], _place(file, cell_id))
        for entry, cell_id in zip(entries(lesson, data), cells, strict=True)
    ]
    return Row(lesson.heading, items, file, lesson.teaches)


def after(exercise: Exercise, data: Data) -> tuple[Row, list[tuple[str, str]]]:
    """Return the lesson of an exercise that was solved, and what comes next.

    Args:
        exercise: It belongs to a lesson.
        data: What the progress file holds.

    Returns:
        The lesson, and pairs of a text and where it is: the next exercise that is not done; if
        all are, the quiz unless it is done, and the next lesson.
    """
    lesson = exercise.belongs_to
    assert lesson is not None
    row = row_of(lesson, data, _own_file())
    exercises = row.of_kind('exercise')
    position = [item.name for item in exercises].index(exercise.name)
    for item in exercises[position + 1 :] + exercises[:position]:
        if item.state != 'done':
            return row, [(f'Next: {item.name}', item.href)]
    questions = [item for item in row.of_kind('question') if item.state != 'done']
    quiz = [('Next: the quiz', item.href) for item in questions[:1]]
    return row, quiz + _next_lesson(lesson)


def onward(data: Data) -> list[tuple[str, str]]:
    """Return where to go on: the first exercise that is open in the lesson of the last attempt.

    Args:
        data: What the progress file holds.
    """
    from labkit.exercises.lesson import all_lessons

    lessons = all_lessons()
    times = [
        max((max(e['passed_at'], e['first_try']) for e in entries(lesson, data)), default='')
        for lesson in lessons
    ]
    if not any(times):
        return [(lesson.heading, lesson.notebook) for lesson in lessons[:1]]
    last = times.index(max(times))
    for lesson in lessons[last:] + lessons[:last]:
        for item in row_of(lesson, data).of_kind('exercise'):
            if item.state != 'done':
                return [(f'{lesson.heading}, {item.name}', item.href)]
    return []


def _next_lesson(lesson: Lesson) -> list[tuple[str, str]]:
    from labkit.exercises.lesson import all_lessons

    later = [other for other in all_lessons() if other.notebook > lesson.notebook]
    return [(f'Next lesson: {other.heading}', other.notebook) for other in later[:1]]


def _own_file() -> str:
    """Return the file name of the notebook that this kernel runs, `''` if it has none."""
    name = Path(settings.notebook_name()).name
    return name if name.endswith('.ipynb') else ''


def _place(notebook: str, cell_id: str) -> str:
    """Return a link to a cell as JupyterLab understands it."""
    return f'{notebook}#cell-id={cell_id}'


def _entry(lesson: str, kind: str, name: str, entry: Mapping[str, Any]) -> dict[str, Any]:
    passed, tries = entry.get('passed_at', ''), number_of(entry.get('tries'))
    return {
        'lesson': lesson,
        'kind': kind,
        'name': name,
        'state': 'done' if passed else 'tried' if tries else 'open',
        'tries': tries,
        'hints': number_of(entry.get('hints')),
        'solution_shown': 'yes' if entry.get('solution') is True else 'no',
        'first_try': entry.get('first_try', ''),
        'passed_at': passed,
    }
