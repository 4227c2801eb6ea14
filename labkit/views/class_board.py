"""What is shown of a class: who is where, what is passed, what fails most; also as text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ['Board', 'FailRow', 'LearnerRow', 'LessonRow', 'text_form']

EMPTY = 'Nobody shares their progress yet. Learners join with lab.join_class().'
TOLD = 'All of this is what the computers of the learners have told.'
NAMES_TOLD = 'So are the names.'
NAMES_OF_ACCOUNTS = 'The names are those of their accounts.'


@dataclass(frozen=True)
class LessonRow:
    """A lesson.

    Attributes:
        title: Its number and its title.
        here: How many learners are at it now.
        exercises: Name of each exercise, how many have passed it, how many others have tried it.
    """

    title: str
    here: int
    exercises: Sequence[tuple[str, int, int]]


@dataclass(frozen=True)
class FailRow:
    """A mistake that learners have not mended yet.

    Attributes:
        count: How many learners.
        exercise: The lesson and the exercise.
        sentence: What the course says about it.
    """

    count: int
    exercise: str
    sentence: str


@dataclass(frozen=True)
class LearnerRow:
    """A learner, for the teacher alone.

    Attributes:
        name: The name in the class.
        lesson: The lesson that is open, `''` if none is.
        done: How many exercises are passed.
        exercise: The exercise of the last check.
        last: Its outcome.
        stuck_min: For so long it has not been passed, min; None if the learner is not stuck.
        quiet_min: So long ago something was heard, min; None if that is not known.
        remark: What can hardly be true, or why nothing can be read; `''` if all is well.
    """

    name: str
    lesson: str = ''
    done: int = 0
    exercise: str = ''
    last: str = ''
    stuck_min: int | None = None
    quiet_min: int | None = None
    remark: str = ''


@dataclass(frozen=True)
class Board:
    """All that is shown of a class.

    Attributes:
        shared: How many learners share.
        at_work: How many of them have been heard of lately.
        stuck: How many of those have been at one exercise for long.
        lessons: Those that anybody has begun.
        fails: What fails most often first.
        learners: Who they are, with those who are stuck first.
        exercise_count: How many exercises the course has.
        certain: Whether the machine vouches for all names.
        silent: How many of the class share nothing, as far as that is known.
        note: What is wrong; `''` if nothing is.
    """

    shared: int = 0
    at_work: int = 0
    stuck: int = 0
    lessons: Sequence[LessonRow] = ()
    fails: Sequence[FailRow] = ()
    learners: Sequence[LearnerRow] = ()
    exercise_count: int = 0
    certain: bool = False
    silent: int = 0
    note: str = ''

    @property
    def told(self) -> str:
        """What can be known of it at all."""
        if not self.shared:
            return EMPTY
        names = NAMES_OF_ACCOUNTS if self.certain else NAMES_TOLD
        silent = f' {self.silent} more of the class share nothing.' if self.silent else ''
        return f'{TOLD} {names}{silent}'


def text_form(board: Board, *, names: bool) -> str:
    """Return a class as lines of text.

    Args:
        board: The class.
        names: Whether to tell who is who.
    """
    lines = [
        f'Class: {board.shared} share their progress, {board.at_work} at work, '
        f'{board.stuck} stuck.'
        if board.shared
        else ''
    ]
    width = max((len(row.title) for row in board.lessons), default=0)
    for row in board.lessons:
        passed = ', '.join(
            f'{name} {done} passed' + (f' {tried} trying' if tried else '')
            for name, done, tried in row.exercises
        )
        lines.append(f'  {row.title:<{width}}  {row.here:>3} here  {passed}'.rstrip())
    if board.fails:
        lines.append('Fails most often, and is not passed yet:')
        lines += [f'  {row.count:>3}  {row.exercise}: {row.sentence}' for row in board.fails]
    if names and board.learners:
        lines.append('Learners:')
        width = max(len(row.name) for row in board.learners)
        lines += [f'  {row.name:<{width}}  {_about(row, board)}' for row in board.learners]
    return '\n'.join(filter(None, [*lines, board.note, board.told]))


def _about(row: LearnerRow, board: Board) -> str:
    if row.quiet_min is None:
        return row.remark
    parts = [
        row.lesson or 'no lesson open',
        f'{row.done} of {board.exercise_count} passed',
        f'{row.exercise} {row.last}' if row.exercise else '',
        f'stuck for {row.stuck_min} min' if row.stuck_min is not None else '',
        f'last sign {row.quiet_min} min ago',
        row.remark,
    ]
    return ', '.join(filter(None, parts))
