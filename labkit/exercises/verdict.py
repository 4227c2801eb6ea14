"""What a check says: PASS, FAIL, NOT ATTEMPTED or ERROR, and how a judge says it.

Inside a check an outcome is an exception: a matcher raises `Fail` or `NotAttempted`, and a check
that returns has passed. Outside there is one `Verdict`, which shows itself and never raises.
"""

from __future__ import annotations

import dataclasses
import enum
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field
from typing import Any

from labkit.exercises.mistakes import Mistake
from labkit.views.card import Card
from labkit.views.passed_card import PassedCard
from labkit.views.progress_picture import Row
from labkit.views.time_line import TimeLine

__all__ = ['Fail', 'LearnerError', 'NotAttempted', 'Outcome', 'Verdict']


# A longer line of a verdict is cut: a message may be of any length.
LONGEST = 800


class Outcome(enum.Enum):
    """The four answers of a check."""

    PASS = 'PASS'
    FAIL = 'FAIL'
    NOT_ATTEMPTED = 'NOT ATTEMPTED'
    ERROR = 'ERROR'


_TONES = {
    Outcome.PASS: 'good',
    Outcome.FAIL: 'bad',
    Outcome.NOT_ATTEMPTED: 'quiet',
    Outcome.ERROR: 'warn',
}


@dataclass(frozen=True, repr=False)
class Verdict:
    """The answer of a check, for people: text in a terminal, a card in a notebook.

    It is true if the check has passed, so that `assert lesson.ones.check()` is a test.

    Attributes:
        outcome: PASS, FAIL, NOT ATTEMPTED or ERROR.
        name: The exercise.
        text: A sentence for the whole.
        expected: What should have been observed.
        seen: What was observed.
        why: The likely misconception.
        todo: The next step.
        trace: The learner's lines of a traceback, and the message of the error.
        note: Something beside the point, such as a progress file that can't be written.
        clause: What of the task is not fulfilled, in its words; `''` if no clause says so.
        mistake: The misconception, where it has a name.
        asked: What the task asks for, clause by clause, where all of it is fulfilled.
        standing: The lesson, and what comes next, where that is known.
        time_line: What came while the check let time pass; None if it let none pass.
        form: Returns a form that shows it in a page, with buttons; None where there is none.
    """

    outcome: Outcome
    name: str
    text: str = ''
    expected: str = ''
    seen: str = ''
    why: str = ''
    todo: str = ''
    trace: str = ''
    note: str = ''
    clause: str = ''
    mistake: Mistake | None = None
    asked: Sequence[str] = ()
    standing: tuple[Row, Sequence[tuple[str, str]]] | None = None
    time_line: TimeLine | None = None
    form: Callable[[], Any] = field(default=lambda: None, compare=False)

    @property
    def passed(self) -> bool:
        """Tell whether the outcome is PASS."""
        return self.outcome is Outcome.PASS

    def __bool__(self) -> bool:
        return self.passed

    def __await__(self) -> Generator[None, None, Verdict]:
        """Let `await` stand before any check: it may be `Pending`, and nobody knows before."""
        yield from ()
        return self

    def with_note(self, note: str) -> Verdict:
        """Return the same verdict with a note, after those that it has."""
        return dataclasses.replace(self, note=f'{self.note} {note}'.strip())

    def _card(self) -> Card:
        rows = [
            (label, _bounded(text))
            for label, text in (
                ('Task', self.clause),
                ('Expected', self.expected),
                ('Seen', self.seen),
                ('Why', self.why),
                ('Next', self.todo),
                ('Note', self.note),
            )
        ]
        word, tone, text = self.outcome.value, _TONES[self.outcome], _bounded(self.text)
        if self.passed:
            row, onward = self.standing or (Row('', ()), ())
            exercises = row.of_kind('exercise')
            return PassedCard(tone, word, self.name, text, rows, '', self.asked, exercises, onward)
        return Card(tone, word, self.name, text, rows, _bounded(self.trace, 4 * LONGEST))

    def __repr__(self) -> str:
        return repr(self._card())

    def _ipython_display_(self) -> None:
        form = None if self.passed else self.form()
        if form is None:
            raise NotImplementedError  # then IPython asks for the forms below
        form.show(self)

    def _repr_html_(self) -> str:
        page = self._card()._repr_html_()
        if self.time_line is None:
            return page
        start, _, _ = page.rpartition('</div>')
        shown = self.time_line._repr_html_()
        if self.passed:
            shown = f'<details><summary>What came, and when</summary>{shown}</details>'
        return f'{start}{shown}</div>'


def _bounded(text: str, longest: int = LONGEST) -> str:
    """Return a text, cut in the middle if nobody would read all of it."""
    if len(text) <= longest:
        return text
    return f'{text[: longest // 2]} ... {text[-longest // 2 :]}'


class Fail(Exception):
    """Say that what was observed is not what the task asks for.

    Args:
        expected: What should have been observed.
        seen: What was observed; values with `!r`.
        mistake: The misconception that leads there, with its next step, where it is known.
        todo: The next step, where it is not that of the mistake.

    Attributes:
        mistake: The mistake, None if it has no name.
        clause: What of the task is not fulfilled, in its words; `''` if no clause says so.
        came_first: Whether it was so before a callback raised, and is no consequence of that.
        made_so: Whether it was so as it was made, whatever callbacks have done since.
        at: When it was seen, in s of the check's time; None if at no single moment.
    """

    def __init__(
        self,
        expected: str,
        seen: str,
        mistake: Mistake | None = None,
        *,
        todo: str = '',
    ) -> None:
        why = mistake.reason if mistake is not None else ''
        todo = todo or (mistake.step if mistake is not None else '')
        super().__init__(f'{expected} / {seen} / {why} / {todo}')
        self.expected = expected
        self.seen = seen
        self.mistake = mistake
        self.why = why
        self.todo = todo
        self.clause = ''
        self.came_first = self.made_so = False
        self.at: float | None = None


class NotAttempted(Exception):
    """Say that nothing of the learner's is there yet."""


class LearnerError(Exception):
    """Say that the learner's code raised.

    Args:
        where: What raised, such as `'The callback on_odd of /evener'`.
        error: The exception.
        trace: The learner's lines of the traceback, and the message.
    """

    def __init__(self, where: str, error: BaseException, trace: str) -> None:
        super().__init__(where)
        self.where = where
        self.error = error
        self.trace = trace
