"""A guess as a row of buttons in the notebook."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import traitlets

from labkit.views.stored_form import Stored
from labkit.views.widget import PageWidget, page_files

__all__ = ['GuessForm']


class GuessForm(PageWidget):
    """A question, and a button for each answer.

    Attributes:
        ask: The question.
        options: What the buttons say.
        guessed: Which one was chosen last, counted from 0; -1 before.
        words: What is said under them.
        fresh: Whether no page has shown it yet. The first one takes the keyboard.
    """

    _esm, _css = page_files('guess_form')
    ask = traitlets.Unicode().tag(sync=True)
    options: traitlets.List[str] = traitlets.List().tag(sync=True)
    guessed = traitlets.Int(-1).tag(sync=True)
    words = traitlets.Unicode().tag(sync=True)
    fresh = traitlets.Bool(True).tag(sync=True)

    def __init__(self, ask: str, options: Sequence[str], take: Callable[[int], Any]) -> None:
        super().__init__(ask=ask, options=list(options))
        self._take = take
        self.on_msg(self._on_message)

    def _on_message(self, _: object, content: dict[str, Any], __: object) -> None:
        index = content.get('guess')
        if type(index) is int and 0 <= index < len(self.options):
            self._take(index)

    def told(self, guessed: int | None, words: str) -> None:
        """Show a guess, and what is to be said about it."""
        self.guessed, self.words = -1 if guessed is None else guessed, words

    def show(self, text: str) -> None:
        """Show the form under the current cell; the text is for viewers without a kernel."""
        Stored(self).show({'text/plain': text})
