"""Clauses of one task alone: words and a function that looks, or words that another one judges."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from labkit.exercises.judging import Clause, Seen

__all__ = ['Asked', 'Words']


@dataclass(frozen=True, eq=False)
class Asked(Clause[Seen]):
    """What no other task asks for.

    Attributes:
        words: What is asked for, in words of the task.
        look: Raises Fail if what was seen is otherwise. It may return that in a sentence.
    """

    words: str
    look: Callable[[Seen], str | None]

    def judge(self, seen: Seen) -> str:
        """Look at it."""
        return self.look(seen) or ''


@dataclass(frozen=True)
class Words(Clause[Any]):
    """What another clause, or the stage, looks at as well.

    Attributes:
        words: What is asked for, in words of the task.
    """

    words: str
