"""Clauses on what the messages of a publisher say, all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from labkit.exercises.clauses.base import Clause, Evidence, Stream
from labkit.exercises.expect.values import show, text_trouble
from labkit.exercises.verdict import Fail

__all__ = ['HasText', 'Messages', 'Says']


@dataclass(frozen=True, eq=False)
class Messages(Clause):
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

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words

    def judge(self, evidence: Evidence) -> str:
        """Judge the messages."""
        return self.rule(evidence.streams[self.topic, self.by]) or ''


@dataclass(frozen=True)
class Says(Clause):
    """A field has one value, in each message.

    Attributes:
        topic: Full name of the topic.
        value: The value.
        field: Name of the field.
        by: Full name of the node; any node if empty.
        todo: The next step for who has another value.
        explain: Gets the values that came; returns the misconception and the next step.
        words: In words of the task; made of the value if empty.
    """

    topic: str
    value: Any
    field: str = 'data'
    by: str = ''
    todo: str = ''
    explain: Callable[[Sequence[Any]], tuple[str, str]] | None = None
    words: str = ''

    @property
    def text(self) -> str:
        """What is asked for."""
        return self.words or f'each message says `{self.value!r}`'

    def judge(self, evidence: Evidence) -> str:
        """Judge the values."""
        stream = evidence.streams[self.topic, self.by]
        values = stream.values(self.field)
        for number, value in enumerate(values):
            if value != self.value:
                why, todo = self.explain(values) if self.explain is not None else ('', '')
                if number and not why:
                    why = 'The first messages were right, the later ones are not.'
                after = f', after {number} that were right' if number else ''
                raise Fail(
                    f'{self.field} = {self.value!r} in each message on {self.topic}',
                    f'{self.field} = {show(values[number:])}{after}',
                    why=why or text_trouble(value, self.value),
                    todo=todo or self.todo,
                )
        return ''


@dataclass(frozen=True)
class HasText(Clause):
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
        return 'no message is empty'

    def judge(self, evidence: Evidence) -> str:
        """Judge the texts."""
        for by in self.by:
            stream = evidence.streams[self.topic, by]
            values = stream.values(self.field)
            number = next((i for i, text in enumerate(values) if not text.strip()), None)
            if number is not None:
                raise Fail(
                    f'a text in each message on {self.topic}',
                    f'{self.field} = {show(values[number:])}'
                    + (f', after {number} with a text' if number else ''),
                    why='The message was published as it was made: its field '
                    f'{self.field} is an empty text at first.'
                    if not values[number]
                    else 'A text of spaces says nothing.',
                    todo=f'Set the field before you publish: msg.{self.field} = ...',
                )
        examples = [evidence.streams[self.topic, by].values(self.field)[0] for by in self.by]
        return f'It says {show(examples)}.'
