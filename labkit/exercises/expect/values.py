"""Matchers for what messages say: values, their order, the step from one to the next."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from labkit.exercises import words
from labkit.exercises.mistakes import Mistake
from labkit.exercises.verdict import Fail

if TYPE_CHECKING:
    from labkit.exercises.clauses.base import Stream
    from labkit.exercises.watch import Watch

__all__ = ['apart', 'digits', 'each', 'first', 'show', 'steps', 'text_trouble']

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
    texts = ((f'{number:.{n}g}', f'{other:.{n}g}') for n in (4, 7))
    return next((text for text, of_other in texts if text != of_other), repr(number))


def _short(value: Any, at: int = 0) -> str:
    text = repr(value)
    if len(text) <= LONGEST:
        return text
    start = at - LONGEST // 2
    if start < 0 or at > len(text):
        return f'{text[: LONGEST // 2]} ... {text[-LONGEST // 4 :]}'
    return f'... {text[start : at + LONGEST // 4]} ...'


def each(
    watch: Watch | Stream,
    field: str,
    rule: Callable[[Any], bool],
    mistake: Mistake | None = None,
    *,
    expected: str,
    why: str = '',
    todo: str = '',
) -> None:
    """Expect that a rule holds for a field of every message.

    Args:
        watch: The messages.
        field: Name of the field, see `Watch.values`.
        rule: Whether a value is right.
        mistake: The likely misconception.
        expected: What the rule asks for, in words.
        why: The likely misconception, in a sentence of its own.
        todo: The next step.

    Raises:
        Fail: It does not hold for one of them.
    """
    values = watch.values(field)
    if not all(rule(value) for value in values):
        seen = f'{field} = {show(values)} on {watch.topic}'
        raise Fail(expected, seen, mistake, why=why, todo=todo)


def steps(watch: Watch | Stream, field: str, step: Any, *, todo: str = '') -> None:
    """Expect a number to grow by the same step from each message to the next.

    Args:
        watch: The messages.
        field: Name of the field.
        step: What the next value has more than the one before it.
        todo: The next step for the learner.

    Raises:
        Fail: The values go otherwise.
    """
    values = watch.values(field)
    differences = [later - earlier for earlier, later in pairwise(values)]
    if all(difference == step for difference in differences):
        return
    raise Fail(
        f'each {field} {step} more than the one before it',
        f'{field} = {show(values)} on {watch.topic}',
        _odd_step(values, differences, step),
        todo=todo,
    )


def first(
    watch: Watch | Stream,
    field: str,
    start: Any,
    step: Any,
    mistake: Mistake | None = None,
    *,
    why: str = '',
) -> None:
    """Expect where a count started, seen from where it is now.

    A message carries the number that it has among those of its publisher. So the first value is
    known even if a check comes late. Call `steps` before.

    Args:
        watch: The messages.
        field: Name of the field.
        start: The value of the first message.
        step: What each message has more than the one before it.
        mistake: The misconception behind another start.
        why: The same in a sentence of its own.

    Raises:
        Fail: It started with another value.
    """
    for value, sample in zip(watch.values(field), watch.samples, strict=True):
        began = value - step * (sample.number - 1)
        if sample.number and began != start:
            raise Fail(
                f'{start} as the first {field}',
                f'message number {sample.number} of {watch.topic} has {field} = {value!r}, so the '
                f'first one had {began!r}',
                mistake,
                why=why,
                todo=f'Set the number to {start} in __init__, and publish before you change it.',
            )


def text_trouble(seen: Any, wanted: Any) -> Mistake | None:
    """Return how a text differs from the one that was wanted, None if there is no simple way."""
    if not isinstance(seen, str) or not isinstance(wanted, str):
        same = type(seen) is type(wanted)
        return None if same else words.VALUE_TYPE.of(kind=type(seen).__name__)
    if seen.strip() == wanted.strip():
        where = 'end' if seen.lstrip() == seen and wanted.lstrip() == wanted else 'start'
        what = 'is missing' if len(seen) < len(wanted) else 'is too much'
        return words.SPACE_AT.of(what=what, where=where)
    if ''.join(seen.split()) == ''.join(wanted.split()):
        return words.SPACES
    if seen.lower() == wanted.lower():
        return words.LETTERS
    if seen.startswith(wanted):
        return words.TOO_LONG.of(more=seen[len(wanted) :])
    if wanted.startswith(seen):
        return words.TOO_SHORT.of(less=wanted[len(seen) :])
    return None


def _odd_step(values: Sequence[Any], differences: Sequence[Any], step: Any) -> Mistake:
    if len(values) > 1 and len(set(map(repr, values))) == 1:
        return words.SAME_VALUE
    if len(set(differences)) == 1:
        return words.OTHER_STEP.of(seen=differences[0], step=step)
    if any(difference < 0 for difference in differences):
        return words.STARTS_OVER
    return words.STEP_CHANGES
