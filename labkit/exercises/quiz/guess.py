"""Guesses: what a learner expects of a cell, before it is run.

`lesson.guess('late')` shows a question with a button for each answer. The cell that tells the
answer runs either way. What was guessed then stands under it, beside what came. A guess is never
wrong: it counts for nothing, and is only kept for the learner and for the class.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from typing import Any

from labkit import settings
from labkit.errors import LabError
from labkit.exercises.learner_errors import last_cell
from labkit.exercises.quiz.questions import LETTERS
from labkit.exercises.record.progress_store import progress_store
from labkit.exercises.words import Words
from labkit.views.card import Card

__all__ = ['Guess', 'guesses_of']

NOT_SHOWN = 'Guess, then run the cell that comes next.'


class Guess:
    """A question that the next cell answers. Displayed, it is a row of buttons.

    Args:
        name: Its name, for `lesson.guess('name')` and in the progress file.
        ask: The question.
        options: What may be guessed: two to four.
        came: The one of them that comes.
        why: Why it comes, in a sentence or two.
        shown_by: Id of the cell that shows what comes.

    Raises:
        ValueError: There are too few or too many options, or what comes is none of them.
    """

    def __init__(
        self, name: str, ask: str, options: Sequence[str], *, came: str, why: str, shown_by: str
    ) -> None:
        if not 2 <= len(options) <= len(LETTERS[:4]) or came not in options:
            raise ValueError(f'{name} needs two to four options, and one of them has to come')
        self.name = name
        self.ask = ask
        self.options = tuple(options)
        self.came = self.options.index(came)
        self.why = why
        self.shown_by = shown_by
        self.lesson = ''
        self._form: Any = None
        # What was guessed since it was asked last.
        self._given: int | None = None
        # Whether the cell has shown the answer since it was asked last.
        self._is_told = False

    def choose(self, letter: str) -> Card:
        """Guess, by the letter of an option.

        Raises:
            LabError: There is no such option.
        """
        last_cell.asked()
        given = letter.strip().lower() if isinstance(letter, str) else ''
        known = LETTERS[: len(self.options)]
        if len(given) != 1 or given not in known:
            raise LabError(
                f'{letter!r} is none of the options.', todo=f'Choose one of {", ".join(known)}.'
            )
        return self._take(known.index(given))

    def _take(self, index: int) -> Card:
        self._given = index
        note = progress_store.note_guess(self.lesson, self.name, index)
        if self._form is not None:
            self._form.told(index, self._words(index))
        else:
            last_cell.after_each(self._look)
        return Card('info', 'GUESSED', self.options[index], rows=self._rows(index, note))

    def _rows(self, index: int | None, note: str = '') -> list[tuple[str, str]]:
        return [('', self._words(index)), ('note', note)]

    def _words(self, index: int | None) -> str:
        """Return what is said beside the buttons: what to do, or what came."""
        if not self._is_told:
            return NOT_SHOWN if index is None else 'Now run the cell that comes next.'
        return f'What came: {self.options[self.came]}. {self.why}'

    def _guessed(self) -> int | None:
        """Return what was guessed last; of earlier sessions, before the answer was known."""
        if self._given is not None:
            return self._given
        found = progress_store.guess(self.lesson, self.name)
        # The file may have been changed by hand.
        return found if type(found) is int and 0 <= found < len(self.options) else None

    def _look(self) -> None:
        """Show the guess under the cell that has just answered it."""
        run = last_cell.run
        if run is None or run.error is not None or run.cell_id != self.shown_by or self._is_told:
            return
        self._is_told = True
        progress_store.note_told(self.lesson, self.name)
        index = self._guessed()
        if self._form is not None:
            self._form.told(index, self._words(index))
        if index is not None and settings.audience().live:
            from IPython.display import display

            right = index == self.came
            word = 'AS YOU GUESSED' if right else 'YOU GUESSED'
            rows = [('', self.why)] if right else [('', self._words(index))]
            display(Card('good' if right else 'info', word, self.options[index], rows=rows))  # type: ignore[no-untyped-call]

    def __repr__(self) -> str:
        options = '   '.join(f'{a}) {b}' for a, b in zip(LETTERS, self.options, strict=False))
        return f'{self.ask}\n  {options}\n{NOT_SHOWN}'

    def _repr_mimebundle_(self, **_: object) -> dict[str, Any]:
        return {'text/plain': repr(self)}

    def _ipython_display_(self) -> None:
        last_cell.asked()
        with contextlib.suppress(ImportError):  # no anywidget: show text
            if settings.audience().live:
                from labkit.views.guess_form import GuessForm

                self._given, self._is_told = None, False
                index = self._guessed()
                self._form = GuessForm(self.ask, self.options, self._take)
                self._form.told(index, self._words(index))
                last_cell.after_each(self._look)
                self._form.show(repr(self))
                return
        raise NotImplementedError  # then IPython asks for the bundle


def guesses_of(words: Words) -> list[Guess]:
    """Return the guesses as a file of words has them, in their order.

    Raises:
        LabError: One of them is no guess.
    """
    told: Mapping[str, Mapping[str, Any]] = words.data.get('guesses', {})
    found = []
    for name, parts in told.items():
        lacking = [
            key for key in ('ask', 'options', 'came', 'why', 'shown_by') if key not in parts
        ]
        if lacking:
            raise LabError(f'The guess {name!r} of {words.path} lacks {", ".join(lacking)}.')
        try:
            found.append(Guess(name, **parts))
        except ValueError as error:
            raise LabError(f'In {words.path}: {error}.') from error
    return found
