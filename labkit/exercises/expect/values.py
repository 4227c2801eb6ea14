"""Values of messages for people, and how a text differs from the one that was wanted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from labkit.exercises import common_mistakes
from labkit.exercises.figures import figure
from labkit.exercises.mistakes import Mistake

__all__ = ['apart', 'digits', 'show', 'text_trouble']

SHOWN = 6
# Longer texts are shown in part.
LONGEST = 120


def show(values: Sequence[Any], *, at: int = 0) -> str:
    """Return values for people: the first few, with `!r`, and of a long text both ends.

    Args:
        values: The values.
        at: What stands there in a long one is shown.
    """
    text = ', '.join(_short(value, at) for value in values[:SHOWN])
    return f'{text}, ...' if len(values) > SHOWN else text


def apart(wanted: Sequence[Any], seen: Sequence[Any]) -> tuple[str, str]:
    """Return two rows of values for people, as `show` does, with the place where they part."""
    pairs = enumerate(zip(wanted, seen, strict=False))
    place = next((i for i, (one, other) in pairs if one != other), min(len(wanted), len(seen)))
    start = place - 2 if place >= SHOWN else 0
    left = f'{start} alike, then ' if start else ''
    at = 0
    if place < min(len(wanted), len(seen)):
        texts = repr(wanted[place]), repr(seen[place])
        at = next((i for i, (a, b) in enumerate(zip(*texts, strict=False)) if a != b), 0)

    def shown(values: Sequence[Any]) -> str:
        return left + show(values[start:], at=at) if values else 'none'

    return shown(wanted), shown(seen)


def digits(number: float, other: float) -> str:
    """Return a number for people, as exactly as it takes to tell it from another one."""
    texts = ((figure(number, n), figure(other, n)) for n in (4, 7, 10))
    return next((text for text, of_other in texts if text != of_other), repr(number))


def _short(value: Any, at: int = 0) -> str:
    text = repr(value)
    if len(text) <= LONGEST:
        return text
    start = at - LONGEST // 2
    if start < 0 or at > len(text):
        return f'{text[: LONGEST // 2]} ... {text[-LONGEST // 4 :]}'
    return f'... {text[start : at + LONGEST // 4]} ...'


def text_trouble(seen: Any, wanted: Any) -> Mistake | None:
    """Return how a text differs from the one that was wanted, None if there is no simple way."""
    if not isinstance(seen, str) or not isinstance(wanted, str):
        same = type(seen) is type(wanted)
        return None if same else common_mistakes.VALUE_TYPE.of(kind=type(seen).__name__)
    if seen.strip() == wanted.strip():
        where = 'end' if seen.lstrip() == seen and wanted.lstrip() == wanted else 'start'
        what = 'is missing' if len(seen) < len(wanted) else 'is too much'
        return common_mistakes.SPACE_AT.of(what=what, where=where)
    if ''.join(seen.split()) == ''.join(wanted.split()):
        return common_mistakes.SPACES
    if seen.lower() == wanted.lower():
        return common_mistakes.LETTERS
    if seen.startswith(wanted):
        return common_mistakes.TOO_LONG.of(more=show([seen[len(wanted) :]]))
    if wanted.startswith(seen):
        return common_mistakes.TOO_SHORT.of(less=show([wanted[len(seen) :]]))
    return None
