"""Mistakes as data: the words for a misconception, and what a program that has it does.

A mistake is named once, beside its exercise, and known everywhere by its id: a verdict says its
words, a judge recognises it by its model, the proof makes it by its change, and a class sheet or
the teacher's view shows it without anything of the learner's.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

from labkit.exercises.figures import filled

__all__ = [
    'NO_ANSWER',
    'Mistake',
    'anything',
    'known_mistakes',
    'recognise',
    'said_by_the_course',
]

# The answer of a program that cannot answer.
NO_ANSWER = object()

# Stands for what differs from learner to learner.
HOLE = '\N{HORIZONTAL ELLIPSIS}'
_VALUE = re.compile(r'(?<!\{)\{[^{}]*\}(?!\})')

_known: dict[str, Mistake] = {}


@dataclass(frozen=True, eq=False)
class Mistake:
    """A misconception: its words, and what a program that has it does.

    Attributes:
        id: Its name, unique in the course, such as `'evens/passed-on'`: that of its exercise and
            its own; empty if it has none.
        why: The misconception, in one or two sentences that a beginner understands. Values of the
            moment have a name in braces, as `str.format` has them.
        todo: The next step, likewise.
        model: What a program with this mistake answers or says, in the form of the right answer
            of the clause that is to recognise it.
        change: What makes the solution such a program: pairs of what is there and what stands
            there instead. The proof makes it, and expects these words.
        raises: A part of what the verdict says where the changed program raises an error. Then it
            is an ERROR, and `why` may be empty.
        values: What stands for the names in braces.
    """

    id: str
    why: str = ''
    todo: str = ''
    model: Callable[..., Any] | None = field(default=None, kw_only=True)
    change: Sequence[tuple[str, str]] = field(default=(), kw_only=True)
    raises: str = field(default='', kw_only=True)
    values: Mapping[str, Any] = field(default_factory=dict, kw_only=True)

    def __post_init__(self) -> None:
        if self.values or not self.id:
            return
        if _known.setdefault(self.id, self) is not self and _known[self.id].why != self.why:
            raise ValueError(f'Two mistakes have the id {self.id!r}.')

    def of(self, **values: Any) -> Mistake:
        """Return it with the values of the moment."""
        return replace(self, values={**self.values, **values})

    def then(self, todo: str) -> Mistake:
        """Return it with another next step, as it is."""
        return replace(self, todo=todo.replace('{', '{{').replace('}', '}}'))

    def answer(self, *heard: Any) -> Any:
        """Return what a program with this mistake answers; `NO_ANSWER` if it cannot answer."""
        try:
            return NO_ANSWER if self.model is None else self.model(*heard)
        except (ArithmeticError, LookupError, TypeError, ValueError):
            return NO_ANSWER

    @property
    def reason(self) -> str:
        """Return the misconception with its values."""
        return filled(self.why, self.values)

    @property
    def step(self) -> str:
        """Return the next step with its values."""
        return filled(self.todo, self.values)

    @property
    def sentence(self) -> str:
        """Return the misconception with `…` for each value: what may be shown to a class."""
        return _VALUE.sub(HOLE, self.why).replace('{{', '{').replace('}}', '}')


class _Anything:
    def __eq__(self, other: object) -> bool:
        return True

    __hash__ = None  # type: ignore[assignment]


def anything(*_: Any) -> Any:
    """Model a program that answers something, whatever it is: for the last of several mistakes."""
    return _Anything()


def known_mistakes() -> Mapping[str, Mistake]:
    """Return the mistakes of all lessons that are loaded, by their ids."""
    return MappingProxyType(_known)


def said_by_the_course(sentence: str) -> bool:
    """Tell whether a sentence is that of a known mistake."""
    return bool(sentence) and sentence in {each.sentence for each in _known.values()}


def recognise(mistakes: Iterable[Mistake], fits: Callable[[Mistake], bool]) -> Mistake | None:
    """Return the first mistake with a model that fits what was seen, None if there is none."""
    return next((each for each in mistakes if each.model is not None and fits(each)), None)
