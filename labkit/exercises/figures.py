"""Numbers as people write them, in all that an exercise says."""

from __future__ import annotations

import math
from collections.abc import Mapping
from string import Formatter
from typing import Any

__all__ = ['figure', 'filled', 'many']

# So many digits tell enough of what was measured.
DIGITS = 3


def figure(number: float, digits: int = DIGITS) -> str:
    """Return a number for people: some digits of it, and no power of ten.

    What stands before the point is whole, however long it is: `2000`, `0.333`, `12.5`.
    """
    if not math.isfinite(number) or number == 0:
        return f'{number:g}'
    places = max(digits - 1 - math.floor(math.log10(abs(number))), 0)
    text = f'{number:.{places}f}'
    return text.rstrip('0').rstrip('.') if '.' in text else text


def many(count: int, what: str) -> str:
    """Return how many there are of something: `'1 message'`, `'12 messages'`."""
    return f'{count} {what}' if count == 1 else f'{count} {what}s'


class _Figures(Formatter):
    """Fills in words: numbers as people write them, texts as they are, or quoted by `!r`."""

    def convert_field(self, value: Any, conversion: str | None) -> Any:
        if isinstance(value, float):
            return figure(value)
        return super().convert_field(value, conversion)


_FIGURES = _Figures()


def filled(text: str, values: Mapping[str, Any]) -> str:
    """Return words of an exercise with values for the names in braces.

    Raises:
        KeyError: One has no value.
    """
    return _FIGURES.vformat(text, (), values)
