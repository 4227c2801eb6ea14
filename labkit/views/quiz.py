"""A quiz as a form in the notebook: real form elements, so keyboard and screen reader work.

The page knows the questions only. An answer goes to the kernel, which says what it thinks of it.
A form listens to nothing, so it has no end: nothing is left behind when its page is gone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import anywidget
import traitlets

from labkit.errors import LabError
from labkit.views.card import Card
from labkit.views.widget import page_files, widget_bundle

__all__ = ['QuizForm', 'quiz_form']


class QuizForm(anywidget.AnyWidget):
    """The form. It knows nothing of quizzes but what it is given.

    Attributes:
        questions: For each one its text, how to answer it, kind of input and labels.
        feedback: For each question that was answered, by number: HTML.
    """

    _esm, _css = page_files('quiz')
    questions: traitlets.List[dict[str, Any]] = traitlets.List().tag(sync=True)
    feedback: traitlets.Dict[str, str] = traitlets.Dict().tag(sync=True)

    def __init__(
        self, questions: Sequence[dict[str, Any]], answer: Callable[[int, Any], Card]
    ) -> None:
        super().__init__(questions=list(questions))
        self._answer = answer
        self.on_msg(self._on_message)

    def _on_message(self, _: object, content: dict[str, Any], __: object) -> None:
        number, given = content.get('number'), content.get('answer')
        if not isinstance(number, int):
            return
        try:
            card = self._answer(number, given)
        except LabError as error:
            card = Card('warn', 'NO ANSWER', error.message, text=error.todo)
        except Exception as error:  # an answer that is read off the graph, which is not there
            text = f'{type(error).__name__}: {error}'
            card = Card('warn', 'CANNOT TELL', 'the graph could not be asked', text=text)
        self.feedback = {**self.feedback, str(number): card._repr_html_()}

    def bundle(self) -> dict[str, object]:
        """Return the data that makes a notebook show the form."""
        return widget_bundle(self)


def quiz_form(questions: Sequence[dict[str, Any]], answer: Callable[[int, Any], Card]) -> QuizForm:
    """Return a form.

    Args:
        questions: For each one `text`, `how`, `kind` (`'radio'`, `'checkbox'` or `'text'`) and
            `labels`.
        answer: Called with the number of a question, from 1, and the answer: letters, or text.

    Returns:
        The form; `bundle()` gives what a cell shows.
    """
    return QuizForm(questions, answer)
