"""A kind of fault, as data, and one that was found."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

__all__ = ['KINDS', 'Fault', 'Kind', 'in_words', 'kind']


@dataclass(frozen=True)
class Kind:
    """A kind of silent fault.

    Attributes:
        id: Its group and name, such as `'names.namespace'`.
        title: The symptom and the cause, in the words in which people look for it.
        todo: What to do.
        quiet: The case that looks similar, and is not told.
        others: Who else tells it.
        guess: What a guess rests on; '' if it is certain.
        aloud: Whether it is shown under its cell, or only where somebody looks for faults.
    """

    id: str
    title: str
    todo: str
    quiet: str
    others: str = 'nobody'
    guess: str = ''
    aloud: bool = True


KINDS: dict[str, Kind] = {}
"""All kinds by their ids, in the order in which they were defined."""


def kind(id: str, title: str, todo: str, quiet: str, **more: Any) -> Kind:
    """Define a kind."""
    made = Kind(id, title, todo, quiet, **more)
    assert id not in KINDS, id
    KINDS[id] = made
    return made


@dataclass(frozen=True)
class Fault:
    """A fault that is there.

    Two are equal if they are the same fault, whatever numbers their sentences have.

    Attributes:
        kind: What kind of fault it is.
        nodes: Full names of the nodes that take part. The first one can be mended.
        about: What it is about: a topic, a parameter, a callback, a frame.
        text: What was seen, as a sentence.
        todo: What to do.
        aloud: Whether it is shown under its cell, see `Kind`.
        cell: The execution under which it is shown, None for the one that made the node.
        topic: The topic on which it passes, if it is about something else.
    """

    kind: Kind
    nodes: tuple[str, ...]
    about: str
    text: str = field(compare=False)
    todo: str = field(compare=False, default='')
    aloud: bool = field(compare=False, default=True)
    cell: Any = field(compare=False, default=None)
    topic: str = field(compare=False, default='')

    @property
    def is_aloud(self) -> bool:
        """Whether it is shown under its cell."""
        return self.aloud and self.kind.aloud

    @property
    def names(self) -> tuple[str, ...]:
        """The names at which it is shown: of nodes, and what it is about."""
        return (*self.nodes, self.about, self.topic)

    def __str__(self) -> str:
        guess = f' This is a guess: {self.kind.guess}.' if self.kind.guess else ''
        return f'{self.text}{guess}'

    @property
    def advice(self) -> str:
        """What to do about it."""
        return self.todo or self.kind.todo


def in_words(faults: Iterable[Fault]) -> str:
    """Return faults as text, each with what to do on a line of its own."""
    return '\n'.join(f'⚠ {fault}\n  → {fault.advice}' for fault in faults)
