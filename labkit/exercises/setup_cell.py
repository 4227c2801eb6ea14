"""What the setup cell of a notebook does: `lesson = lab.lesson('odds')`."""

from __future__ import annotations

from labkit import settings
from labkit.exercises.found_lessons import load
from labkit.exercises.learner_errors import last_cell
from labkit.exercises.lesson import Lesson
from labkit.exercises.record.membership import follow_class
from labkit.exercises.record.progress_page import follow_progress
from labkit.exercises.time import learner_time
from labkit.exercises.variants import variants_card

__all__ = ['begin', 'lesson']


def lesson(name: str) -> Lesson:
    """Return the exercises and quizzes of a lesson. Called in the setup cell of its notebook.

    Args:
        name: Name of the lesson, such as `'odds'` or `'04_odds'`.

    Raises:
        LabError: There is no such lesson.
    """
    found = load(name)
    if settings.in_kernel():
        learner_time.install()
    return begin(found)


def begin(found: Lesson) -> Lesson:
    """Prepare all exercises of a lesson, and return it."""
    last_cell.follow()
    for exercise in found.exercises:
        exercise.begin()
    follow_progress()
    follow_class(found.name)
    card = variants_card(found.exercises)
    if card is not None:
        from IPython.display import display

        display(card)  # type: ignore[no-untyped-call]
    return found
