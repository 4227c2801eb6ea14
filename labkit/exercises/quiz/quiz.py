"""Quizzes: questions with an explanation for each answer, right or wrong.

In a notebook a quiz is a form; elsewhere, and where a program runs the notebook, it is text, and
`quiz.answer(1, 'b')` answers it. The right answer may depend on the live graph.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from typing import Any

from labkit import settings
from labkit.errors import LabError
from labkit.exercises.learner_errors import last_cell
from labkit.exercises.quiz.questions import LETTERS, Question, question_of
from labkit.exercises.record.progress_store import progress_store
from labkit.exercises.words import Words
from labkit.views.card import Card

__all__ = ['Quiz']


class Quiz:
    """A list of questions. Displayed, it is a form; `answer()` answers one in code.

    Args:
        name: Its name, for `lesson.quiz('name')` and in the progress file.
        questions: The questions.
        cell_id: Id of the notebook cell that shows it.
    """

    def __init__(self, name: str, *questions: Question, cell_id: str = 'quiz') -> None:
        self.name = name
        self.cell_id = cell_id
        self.questions = questions
        self.lesson = ''
        self._form: Any = None

    @staticmethod
    def of(
        words: Words, name: str, cell_id: str = 'quiz', **live: Mapping[str, Callable[..., Any]]
    ) -> Quiz:
        """Return a quiz as a file of words has it.

        Args:
            words: The words of the module.
            name: The quiz.
            cell_id: As for `Quiz`.
            live: What the graph tells of a question, by the question's `id`: the `answer`, how to
                `explain` another one, the `form` in which a word is compared.

        Raises:
            LabError: The file does not have such a quiz, or such questions.
        """
        told = words.data.get('quizzes', {}).get(name, ())
        ids = [each['id'] for each in told if 'id' in each]
        if not told or sorted(ids) != sorted(live):
            raise LabError(
                f'A quiz {name!r} with questions of the ids {sorted(live)} is expected in '
                f'{words.path}, and {sorted(ids) if told else "no such quiz"} is there.'
            )
        try:
            questions = [question_of(each, **live.get(each.get('id', ''), {})) for each in told]
        except ValueError as error:
            raise LabError(f'In the quiz {name!r} of {words.path} {error}.') from error
        return Quiz(name, *questions, cell_id=cell_id)

    def __len__(self) -> int:
        return len(self.questions)

    def answer(self, number: int, given: Any) -> Card:
        """Answer a question.

        Args:
            number: The question's number, from 1.
            given: A letter, several letters, a number or a word.

        Returns:
            A card that explains what is right or wrong.

        Raises:
            LabError: There is no such question, or the answer is invalid.
        """
        last_cell.asked()
        if not isinstance(number, int) or not 1 <= number <= len(self):
            raise LabError(f'Questions are numbered 1 to {len(self)}, but this is {number!r}.')
        feedback = self.questions[number - 1].judge(given)
        note = progress_store.note_answer(
            self.lesson, self.name, number, feedback.is_right, str(given)
        )
        word, tone = ('RIGHT', 'good') if feedback.is_right else ('NOT YET', 'bad')
        rows = [*feedback.lines, ('note', note)]
        return Card(tone, word, f'question {number}', rows=rows)

    def __repr__(self) -> str:
        call = f"lesson.quiz('{self.name}').answer"
        example = self.questions[0].example() if self.questions else ''
        lines = [f'Quiz {self.name!r}. To answer question 1: {call}(1, {example})']
        for number, question in enumerate(self.questions, start=1):
            lines.append(f'{number:2}. {question.text} ({question.how})')
            labels = zip(LETTERS, question.labels(), strict=False)
            lines += [f'      {letter}) {label}' for letter, label in labels]
        return '\n'.join(lines)

    def _repr_mimebundle_(self, **_: object) -> dict[str, Any]:
        return {'text/plain': repr(self)}

    def _ipython_display_(self) -> None:
        with contextlib.suppress(ImportError):  # no ipywidgets or anywidget: show text
            if settings.audience().live:
                from labkit.views.quiz_form import quiz_form

                self._form = self._form or quiz_form(
                    self.form_data(),
                    self.answer,
                    progress_store.answers(self.lesson, self.name),
                )
                self._form.show(repr(self))
                return
        raise NotImplementedError  # then IPython asks for the bundle

    def form_data(self) -> list[dict[str, Any]]:
        """Return the questions for the form, without the right answers."""
        return [
            {
                'text': question.text,
                'how': question.how,
                'kind': question.kind,
                'labels': question.labels(),
            }
            for question in self.questions
        ]
