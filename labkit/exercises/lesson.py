"""The exercises and quizzes of one notebook, each found by its name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType, ModuleType

from labkit.errors import LabError, did_you_mean
from labkit.exercises.exercise import Exercise
from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.lesson_progress import next_steps
from labkit.exercises.quiz.guess import Guess
from labkit.exercises.quiz.quiz import Quiz
from labkit.exercises.record.progress_store import progress_store
from labkit.exercises.what_is_asked import Role
from labkit.views.card import Card
from labkit.views.progress_picture import Row

__all__ = ['Lesson', 'NoSuchNameError']


class NoSuchNameError(LabError, AttributeError):
    """A lesson has no exercise of a name."""


class Lesson:
    """The exercises and quizzes of one notebook. Exercises are its attributes.

    Args:
        name: Name of its module in `labkit.lessons`, such as `'odds'`.
        notebook: File name of the notebook, such as `'04_odds.ipynb'`.
        title: The heading of the notebook.
        teaches: Its subject in a few words, as in the README.
        minutes: How long it takes, as its first cell says.
        exercises: The exercises in the order of the notebook, or the modules that have each an
            `exercise`.
        quizzes: The quizzes in the order of the notebook.
        guesses: What may be guessed, in the order of the notebook.
        topics: Further topics that the lesson's own cells use.
        given: Full names of nodes that the lesson's own cells leave running, see `Exercise`.

    Raises:
        LabError: Two exercises or two quizzes have the same name, or an exercise's name can't be
            an attribute.
    """

    def __init__(
        self,
        name: str,
        notebook: str,
        *,
        title: str = '',
        teaches: str = '',
        minutes: int = 0,
        exercises: Sequence[Exercise | ModuleType] = (),
        quizzes: Sequence[Quiz] = (),
        guesses: Sequence[Guess] = (),
        topics: Sequence[str] = (),
        given: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self.name = name
        self.notebook = notebook
        self.title = title
        self.teaches = teaches
        self.minutes = minutes
        these = [each if isinstance(each, Exercise) else each.exercise for each in exercises]
        self._refuse_names('exercises', these)
        self._refuse_names('quizzes', quizzes)
        self._exercises = {exercise.name: exercise for exercise in these}
        self._quizzes = {quiz.name: quiz for quiz in quizzes}
        self._guesses = {guess.name: guess for guess in guesses}
        known = frozenset(topics).union(*(exercise.scope.topics for exercise in these))
        of_lesson = frozenset(role for e in these for role in e.scope.roles)
        earlier: frozenset[Role] = frozenset()
        for exercise in these:
            scope = exercise.scope
            exercise.lesson = name
            exercise.belongs_to = self
            exercise.scope = replace(
                scope,
                known=known,
                given={**given, **scope.given},
                earlier=earlier,
                of_lesson=of_lesson,
            )
            earlier |= scope.roles.keys()
        for quiz in quizzes:
            quiz.lesson = name
        for guess in guesses:
            guess.lesson = name

    def _refuse_names(self, kind: str, named: Sequence[Exercise] | Sequence[Quiz]) -> None:
        seen: set[str] = set()
        for name in (each.name for each in named):
            if name in seen:
                raise LabError(
                    f'Lesson {self.name!r} has two {kind} called {name!r}.',
                    todo='Give each a name of its own.',
                )
            seen.add(name)
            taken = name.startswith('_') or name in vars(self) or hasattr(Lesson, name)
            if kind == 'exercises' and (taken or not name.isidentifier()):
                raise LabError(
                    f'An exercise of lesson {self.name!r} can not be called {name!r}: '
                    f'lesson.{name} would not be the exercise.',
                    todo='Give it another name.',
                )

    def standing(self, solved: Exercise) -> tuple[Row, list[tuple[str, str]]]:
        """Return this lesson's row of the progress picture, and what comes after an exercise."""
        data = progress_store.store.read()[0]
        return next_steps(self, solved.name, data, all_lessons())

    @property
    def heading(self) -> str:
        """Its number and title: `'04 Odd numbers'`."""
        number, _, rest = self.notebook.removesuffix('.ipynb').partition('_')
        return f'{number} {self.title or rest.replace("_", " ")}'

    @property
    def exercises(self) -> list[Exercise]:
        """The exercises, in the order of the notebook."""
        return list(self._exercises.values())

    @property
    def quizzes(self) -> list[Quiz]:
        """The quizzes, in the order of the notebook."""
        return list(self._quizzes.values())

    def quiz(self, name: str = '') -> Quiz:
        """Return a quiz, to be shown by the notebook.

        Args:
            name: Its name; without one, it is the quiz that the cell `quiz` shows.

        Raises:
            LabError: There is no such quiz.
        """
        own = [quiz for quiz in self.quizzes if quiz.cell_id == 'quiz']
        if not name and len(own) == 1:
            return own[0]
        if name not in self._quizzes:
            names = [repr(other) for other in self._quizzes]
            raise LabError(
                f'Lesson {self.name!r} has no quiz {name!r}.' if name else 'Which quiz?',
                todo=did_you_mean(name, list(self._quizzes))
                or f'Its quizzes: {", ".join(names) or "none"}.',
            )
        return self._quizzes[name]

    @property
    def guesses(self) -> list[Guess]:
        """What may be guessed, in the order of the notebook."""
        return list(self._guesses.values())

    def guess(self, name: str) -> Guess:
        """Return a guess, to be shown by the notebook: what will the next cell show?

        Raises:
            LabError: There is no such guess.
        """
        if name not in self._guesses:
            raise LabError(
                f'Lesson {self.name!r} has no guess {name!r}.',
                todo=did_you_mean(name, list(self._guesses))
                or f'Its guesses: {", ".join(self._guesses) or "none"}.',
            )
        return self._guesses[name]

    def __getattr__(self, name: str) -> Exercise:
        if name.startswith('_'):
            raise AttributeError(name)
        exercise = self._exercises.get(name)
        if exercise is None:
            elsewhere = [other.heading for other in all_lessons() if name in other._exercises]
            raise NoSuchNameError(
                f'Lesson {self.name!r} has no exercise {name!r}.',
                todo=(f'It is in lesson {elsewhere[0]}.' if elsewhere else '')
                or did_you_mean(name, list(self._exercises))
                or f'Its exercises: {", ".join(self._exercises) or "none"}.',
            )
        return exercise

    def __dir__(self) -> list[str]:
        return [*self._exercises, 'quiz', *['guess'] * bool(self._guesses)]

    def _card(self) -> Card:
        rows = [(exercise.name, exercise.task) for exercise in self.exercises]
        rows += [
            (f'quiz({quiz.name!r})', f'{len(quiz)} question' + 's' * (len(quiz) != 1))
            for quiz in self.quizzes
        ]
        return Card('info', 'LESSON', self.name, rows=rows)

    def __repr__(self) -> str:
        return repr(self._card())

    def _repr_html_(self) -> str:
        return self._card()._repr_html_()
