"""Several faults in one line of the doctor's table, each with what to do."""

from __future__ import annotations

from collections.abc import Sequence

from labkit.errors import LabError

__all__ = ['TODO', 'Found']

# What stands before what to do.
TODO = '→ '


class Found(LabError):
    """Faults that were found together.

    Args:
        faults: What was seen and what to do, the one to be mended first at the beginning; '' where
            there is nothing to do.

    Attributes:
        lines: What was seen, and below it what to do; once for faults that are mended alike.
    """

    def __init__(self, faults: Sequence[tuple[str, str]]) -> None:
        seen: dict[str, list[str]] = {}
        for text, todo in faults:
            seen.setdefault(todo, []).append(text)
        self.lines = tuple(
            line
            for todo, texts in seen.items()
            for line in (*texts, *[f'{TODO}{todo}'] * bool(todo))
        )
        todo = ' '.join(filter(None, seen))
        super().__init__(' '.join(text for text, _ in faults), todo=todo)
