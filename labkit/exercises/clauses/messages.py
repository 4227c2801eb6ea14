"""Clauses on what the messages of a publisher say, all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from labkit.exercises import common_mistakes
from labkit.exercises.clauses.base import Evidence, GraphClause, Stream
from labkit.exercises.expect.values import show, text_trouble
from labkit.exercises.mistakes import Mistake, recognise
from labkit.exercises.verdict import Fail
from labkit.exercises.words import words_of

__all__ = ['HasText', 'Messages', 'Says']

WORDS = words_of(__file__)


@dataclass(frozen=True, eq=False)
class Messages(GraphClause):
    """What the messages of a publisher say, all of them, from the first to the last that came.

    Attributes:
        topic: Full name of the topic. A clause on its rate stands before this one.
        words: What is asked for, in words of the task.
        rule: Gets the messages, and raises Fail if they say something else.
        by: Full name of the node; any node if empty.
    """

    topic: str
    words: str
    rule: Callable[[Stream], str | None]
    by: str = ''

    def judge(self, evidence: Evidence) -> str:
        """Judge the messages."""
        return self.rule(evidence.streams[self.topic, self.by]) or ''


@dataclass(frozen=True)
class Says(GraphClause):
    """A field has one value, in each message.

    Attributes:
        topic: Full name of the topic.
        value: The value.
        field: Name of the field.
        by: Full name of the node; any node if empty.
        mistakes: What a wrong node may say instead, each time: the value of a model.
        words: What is asked for, in words of the task; by default that each says the value.
    """

    topic: str
    value: Any
    field: str = 'data'
    by: str = ''
    mistakes: Sequence[Mistake] = ()
    words: str = ''

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words or WORDS.of(value=repr(self.value)).clause('says')

    def judge(self, evidence: Evidence) -> str:
        """Judge the values."""
        stream = evidence.streams[self.topic, self.by]
        values = stream.values(self.field, earlier=True)
        for number, value in enumerate(values):
            if value != self.value:
                after = f', after {number} that were right' if number else ''
                after += ', before the check' if number < len(stream.earlier) else ''
                raise Fail(
                    f'{self.field} = {self.value!r} in each message on {self.topic}',
                    f'{self.field} = {show(values[number:])}{after}',
                    self._mistake(values, number),
                )
        return ''

    def _mistake(self, values: Sequence[Any], number: int) -> Mistake | None:
        """Return the reason why the values are wrong from a message on."""
        if any(value != values[number] for value in values[number:]):
            return common_mistakes.CHANGES
        if number:
            return common_mistakes.LATER_WRONG
        found = recognise(self.mistakes, lambda each: bool(each.answer() == values[0]))
        return found or text_trouble(values[0], self.value)


@dataclass(frozen=True)
class HasText(GraphClause):
    """A text field is not empty, in any message of some publishers.

    Attributes:
        topic: Full name of the topic. A clause on the rate stands before this one.
        by: Full names of the nodes; any node if there is one empty name.
        field: Name of the field.
    """

    topic: str
    by: Sequence[str] = ('',)
    field: str = 'data'

    @property
    def text(self) -> str:
        """What is asked for."""
        return WORDS.clause('has-text')

    def judge(self, evidence: Evidence) -> str:
        """Judge the texts."""
        for by in self.by:
            stream = evidence.streams[self.topic, by]
            values = stream.values(self.field, earlier=True)
            number = next((i for i, text in enumerate(values) if not text.strip()), None)
            if number is not None:
                mistake = common_mistakes.EMPTY_LATER if number else common_mistakes.NOT_SET
                if values[number]:
                    mistake = common_mistakes.ONLY_SPACES
                raise Fail(
                    f'a text in each message on {self.topic}',
                    f'{self.field} = {show(values[number:])}'
                    + (f', after {number} with a text' if number else ''),
                    mistake.of(field=self.field),
                )
        examples = [evidence.streams[self.topic, by].values(self.field)[0] for by in self.by]
        return f'It says {show(examples)}.'
