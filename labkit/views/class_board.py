"""The state of a class: who is where, what is passed, what fails most; also as text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ['Board', 'FailRow', 'GuessRow', 'LearnerRow', 'LessonRow', 'text_form']

EMPTY = 'Nobody shares their progress yet. Learners join with lab.join_class().'
TOLD = 'All of this is what the computers of the learners have told.'
NAMES_TOLD = 'So are the names.'
NAMES_OF_ACCOUNTS = 'The names are those of their accounts.'


@dataclass(frozen=True)
class LessonRow:
    """A lesson.

    Attributes:
        title: Number and title.
        here: Number of learners who are working on it.
        exercises: For each exercise its name, and how many have passed it or only tried it.
    """

    title: str
    here: int
    exercises: Sequence[tuple[str, int, int]]


@dataclass(frozen=True)
class FailRow:
    """A mistake that learners have not fixed yet.

    Attributes:
        count: Number of learners.
        exercise: Lesson and exercise.
        sentence: The course's explanation.
    """

    count: int
    exercise: str
    sentence: str


@dataclass(frozen=True)
class GuessRow:
    """What the class has guessed.

    Attributes:
        title: The lesson.
        ask: The question.
        options: For each option its words, how many guessed it before its cell was run, and how
            many after it.
        came: Which option came, from 0.
    """

    title: str
    ask: str
    options: Sequence[tuple[str, int, int]]
    came: int


@dataclass(frozen=True)
class LearnerRow:
    """A learner, visible to the teacher only.

    Attributes:
        name: Name in the class.
        lesson: The open lesson, `''` for none.
        done: Number of passed exercises.
        exercise: The exercise of the last check.
        last: Outcome of that check.
        stuck_min: Time since the learner got stuck, min; None if not stuck.
        quiet_min: Time since the last sign of life, min; None if unknown.
        since_min: Time since the lesson was opened, min; None if unknown.
        marks: When something was tried or passed in the last two hours: minutes ago, and whether
            it was passed; oldest first.
        remark: Why the data is implausible or unreadable; `''` if it is fine.
    """

    name: str
    lesson: str = ''
    done: int = 0
    exercise: str = ''
    last: str = ''
    stuck_min: int | None = None
    quiet_min: int | None = None
    since_min: int | None = None
    marks: Sequence[tuple[int, bool]] = ()
    remark: str = ''


@dataclass(frozen=True)
class Board:
    """The state of a class.

    Attributes:
        shared: Number of learners who share their progress.
        at_work: Number of those with recent activity.
        stuck: Number of those who have been at one exercise for long.
        lessons: Lessons that anybody has begun.
        fails: Most frequent failures first.
        guesses: What was guessed in the lessons that somebody works on.
        learners: Learners, those who are stuck first.
        exercise_count: Number of exercises in the course.
        certain: Whether names are those of accounts, which learners can't choose.
        silent: Number of learners in the class who share nothing, as far as known.
        note: Any problem; `''` if there is none.
    """

    shared: int = 0
    at_work: int = 0
    stuck: int = 0
    lessons: Sequence[LessonRow] = ()
    fails: Sequence[FailRow] = ()
    guesses: Sequence[GuessRow] = ()
    learners: Sequence[LearnerRow] = ()
    exercise_count: int = 0
    certain: bool = False
    silent: int = 0
    note: str = ''

    @property
    def told(self) -> str:
        """How far the data can be trusted."""
        if not self.shared:
            return '' if self.note else EMPTY
        names = NAMES_OF_ACCOUNTS if self.certain else NAMES_TOLD
        silent = f' {self.silent} more of the class share nothing.' if self.silent else ''
        return f'{TOLD} {names}{silent}'


def text_form(board: Board, *, names: bool) -> str:
    """Return a class as lines of text, with the names of learners if `names`."""
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
    if board.guesses:
        lines.append('Guesses, before and after the answer; * is what came:')
    for guess in board.guesses:
        lines.append(f'  {guess.title}: {guess.ask}')
        for index, (option, before, after) in enumerate(guess.options):
            lines.append(f'    {before:>3} {after:>3}  {option}{" *" * (index == guess.came)}')
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
