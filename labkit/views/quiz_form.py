"""A quiz as a form in the notebook, of real form elements for keyboard and screen reader.

The page knows only the questions. Answers go to the kernel, which judges them. A form subscribes
to nothing, so it needs no end: nothing is left behind when its page is gone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import traitlets

from labkit.errors import LabError
from labkit.views.card import Card
from labkit.views.stored_form import Stored
from labkit.views.widget import PageWidget, page_files

__all__ = ['QuizForm', 'quiz_form']


class QuizForm(PageWidget):
    """A form of questions.

    Attributes:
        questions: For each one its text, instructions, kind of input and labels.
        answers: Judged answers by question number: what was `given`, the `tone` and `word` of the
            verdict, its `rows`, and a `count` that is new each time.
        fresh: Whether no page has shown it since its cell ran. The first one takes the keyboard.
    """

    _esm, _css = page_files('quiz_form')
    questions: traitlets.List[dict[str, Any]] = traitlets.List().tag(sync=True)
    answers: traitlets.Dict[str, dict[str, Any]] = traitlets.Dict().tag(sync=True)
    fresh = traitlets.Bool(True).tag(sync=True)

    def __init__(
        self,
        questions: Sequence[dict[str, Any]],
        answer: Callable[[int, Any], Card],
        earlier: Mapping[int, tuple[str, bool]],
    ) -> None:
        super().__init__(questions=list(questions))
        self._answer = answer
        self._count = 0
        for number, (given, is_right) in earlier.items():
            tone, word = ('good', 'RIGHT') if is_right else ('bad', 'NOT YET')
            self._show(number, given, Card(tone, f'{word}, when you answered it before', ''))
        self.on_msg(self._on_message)

    def _on_message(self, _: object, content: dict[str, Any], __: object) -> None:
        number, given = content.get('number'), content.get('answer')
        if not isinstance(number, int):
            return
        try:
            card = self._answer(number, given)
        except LabError as error:
            rows = [('', error.message), ('', error.todo)]
            card = Card('warn', 'NO ANSWER', '', rows=rows)
        except Exception as error:  # the right answer comes from a graph that can't be read
            rows = [('', f'The graph could not be asked: {type(error).__name__}: {error}')]
            card = Card('warn', 'CANNOT TELL', '', rows=rows)
        self._show(number, str(given), card)

    def _show(self, number: int, given: str, card: Card) -> None:
        self._count += 1
        answer = {
            'given': given,
            'tone': card.tone,
            'word': card.word,
            'rows': [row for row in card.rows if row[1]],
            'count': self._count,
        }
        self.answers = {**self.answers, str(number): answer}

    def show(self, text: str) -> None:
        """Show the form under the current cell; the text is for viewers without a kernel."""
        self.fresh = True
        Stored(self).show({'text/plain': text})


def quiz_form(
    questions: Sequence[dict[str, Any]],
    answer: Callable[[int, Any], Card],
    earlier: Mapping[int, tuple[str, bool]] = MappingProxyType({}),
) -> QuizForm:
    """Return a form, which `show()` shows under a cell.

    Args:
        questions: For each one `text`, `how`, `kind` (`'radio'`, `'checkbox'` or `'text'`) and
            `labels`.
        answer: Judge of an answer: called with the question number, from 1, and letters or text.
        earlier: Earlier answers by question number, and whether they were right.
    """
    return QuizForm(questions, answer, earlier)
