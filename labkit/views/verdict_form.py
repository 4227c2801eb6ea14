"""A verdict in a page, with buttons under it: a hint, the check once more, a solution."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import traitlets
from ipywidgets import Output, VBox

from labkit.background.compat import call_in_kernel
from labkit.views.card import Card
from labkit.views.stored_form import Stored
from labkit.views.widget import PageWidget, page_files

__all__ = ['Helper', 'VerdictForm']


class Helper(Protocol):
    """What the buttons ask: an exercise."""

    @property
    def hints(self) -> Sequence[str]:
        """The hints."""

    @property
    def may_solve(self) -> bool:
        """Whether all hints have been seen, so that the solution is offered."""

    def told_hint(self, number: int) -> Card:
        """Return a hint by its number, from 1."""

    def told_solution(self) -> Card:
        """Return the solution."""

    def refusal(self) -> str:
        """Return why nothing can be checked now, `''` if it can; asked in any thread."""

    def check_again(self, form: VerdictForm) -> str:
        """Check, and update the form, at once or later; return why not, `''` if so.

        It is called in the main thread, and not while that runs code of a cell.
        """


class VerdictForm(PageWidget):
    """Buttons, and above them the verdict and what has come of the buttons.

    JupyterLab draws the cards, so their links and scripts work.

    Args:
        exercise: Whose hints, solution and check they are.

    Attributes:
        count: How many hints there are.
        told: How many of them are shown.
        solves: Whether there is a button for the solution.
        done: Whether nothing is left to do, so that there are no buttons.
        busy: Whether a check is at work.
        words: What is said beside the buttons.
        heard: How many presses have been heard.
    """

    _esm, _css = page_files('verdict_form')
    count = traitlets.Int().tag(sync=True)
    told = traitlets.Int().tag(sync=True)
    solves = traitlets.Bool().tag(sync=True)
    done = traitlets.Bool().tag(sync=True)
    busy = traitlets.Bool().tag(sync=True)
    words = traitlets.Unicode().tag(sync=True)
    heard = traitlets.Int().tag(sync=True)

    def __init__(self, exercise: Helper) -> None:
        super().__init__(count=len(exercise.hints), solves=exercise.may_solve)
        self._exercise = exercise
        # What is shown, by what it is.
        self._cards: dict[str, Any] = {}
        self._output = Output()
        self._box = VBox([self._output, self])
        self._stored = Stored(self, shown=self._box)
        self.on_msg(self._on_message)

    def show(self, verdict: Any, *, busy: bool = False) -> None:
        """Show the form under the current cell, with a verdict, or that it is about to come."""
        self._cards['verdict'], self.busy = verdict, busy
        self._draw()
        self._stored.show(self._still())

    def update(self, verdict: Any) -> None:
        """Let a verdict take the place of what was shown before."""
        before, self._cards['verdict'] = self._cards['verdict'], verdict
        word, same = verdict.outcome.value, repr(verdict) == repr(before)
        self.done = verdict.passed
        if self.done:  # what helped has done so
            self._cards = {'verdict': verdict}
        self._draw()
        self.words, self.busy = f'{word}, as before.' if same else f'{word}.', False

    def _on_message(self, _: object, content: dict[str, Any], __: object) -> None:
        ask = content.get('ask')
        self.heard += 1
        if ask == 'hint' and self.told < self.count:
            self.told += 1
            self._cards[f'hint {self.told}'] = self._exercise.told_hint(self.told)
            self.words = f'Hint {self.told} of {self.count} is above.'
        elif ask == 'solution' and self.solves:
            self._cards['solution'] = self._exercise.told_solution()
            self.words = 'The solution is above.'
        elif ask == 'check' and not (self.busy or self.done):
            refusal = self._exercise.refusal()
            self.words = refusal or 'Checking ...'
            if not refusal:
                self.busy = True
                call_in_kernel(self._check)
        self.solves = self._exercise.may_solve
        self._draw()

    def _check(self) -> None:
        refusal = self._exercise.check_again(self)
        if refusal:
            self.busy, self.words = False, refusal

    def _still(self) -> dict[str, str]:
        """Return what is shown as text and as HTML."""
        cards = self._cards.values()
        return {
            'text/plain': '\n'.join(map(repr, cards)),
            'text/html': '\n'.join(card._repr_html_() for card in cards),
        }

    def _draw(self) -> None:
        still = self._still()
        shown = {'output_type': 'display_data', 'data': still, 'metadata': {}}
        self._output.outputs = (shown,)
        self._stored.update(still)
