"""Matchers for what messages say: values, their order, the step from one to the next."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from labkit.exercises.verdict import Fail

if TYPE_CHECKING:
    from labkit.exercises.clauses.base import Stream
    from labkit.exercises.watch import Watch

__all__ = ['each', 'equal', 'first', 'show', 'steps', 'text_trouble']

SHOWN = 6
# Longer texts are shown in part.
LONGEST = 120


def show(values: Sequence[Any]) -> str:
    """Return values for people: the first few, with `!r`, and of a long text both ends."""
    text = ', '.join(map(_short, values[:SHOWN]))
    return f'{text}, ...' if len(values) > SHOWN else text


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= LONGEST else f'{text[: LONGEST // 2]} ... {text[-LONGEST // 4 :]}'


def each(
    watch: Watch | Stream,
    field: str,
    rule: Callable[[Any], bool],
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
        expected: What the rule asks for, in words.
        why: The likely misconception.
        todo: The next step.

    Raises:
        Fail: It does not hold for one of them.
    """
    values = watch.values(field)
    if not all(rule(value) for value in values):
        raise Fail(expected, f'{field} = {show(values)} on {watch.topic}', why=why, todo=todo)


def equal(
    watch: Watch | Stream, field: str, wanted: Any, *, why: str = '', todo: str = ''
) -> None:
    """Expect one value in every message. For a text it is said where it differs.

    Raises:
        Fail: A message has another one.
    """
    for value in watch.values(field):
        if value != wanted:
            trouble = text_trouble(value, wanted)
            raise Fail(
                f'{field} = {wanted!r} on {watch.topic}',
                f'{field} = {value!r}',
                why=why or trouble,
                todo=todo,
            )


def steps(watch: Watch | Stream, field: str, step: Any, *, why: str = '', todo: str = '') -> None:
    """Expect a number to grow by the same step from each message to the next.

    Args:
        watch: The messages.
        field: Name of the field.
        step: What the next value has more than the one before it.
        why: The misconception behind another step; told from the values if empty.
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
        why=_standstill(values) or why or _odd_step(differences, step),
        todo=todo or 'Keep the number in the node (self.number), and change it once a message.',
    )


def first(
    watch: Watch | Stream, field: str, start: Any, step: Any, *, why: str = '', todo: str = ''
) -> None:
    """Expect where a count started, seen from where it is now.

    A message carries the number that it has among those of its publisher. So the first value is
    known even if a check comes late. Call `steps` before.

    Args:
        watch: The messages.
        field: Name of the field.
        start: The value of the first message.
        step: What each message has more than the one before it.
        why: The misconception behind another start.
        todo: The next step for the learner.

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
                why=why,
                todo=todo
                or f'Set the number to {start} in __init__, and publish before you change it.',
            )


def text_trouble(seen: Any, wanted: Any) -> str:
    """Say how a text differs from the one that was wanted, '' if there is no simple way."""
    if not isinstance(seen, str) or not isinstance(wanted, str):
        return '' if type(seen) is type(wanted) else f'The value is a {type(seen).__name__}.'
    if seen.strip() == wanted.strip():
        where = 'end' if seen.lstrip() == seen and wanted.lstrip() == wanted else 'start'
        what = 'is missing' if len(seen) < len(wanted) else 'is too much'
        return f'A space {what} at the {where} of the text. A space is a character like any other.'
    if ''.join(seen.split()) == ''.join(wanted.split()):
        return 'The spaces are not where they should be. A space is a character like any other.'
    if seen.lower() == wanted.lower():
        return 'Capital and small letters differ.'
    if seen.startswith(wanted):
        return f'The text goes on after that, with {seen[len(wanted) :]!r}.'
    if wanted.startswith(seen):
        return f'The text ends too early: {wanted[len(seen) :]!r} is missing.'
    return ''


def _standstill(values: Sequence[Any]) -> str:
    if len(values) > 1 and len(set(map(repr, values))) == 1:
        return (
            'Every message says the same: the value is made once, and not changed between one '
            'message and the next.'
        )
    return ''


def _odd_step(differences: Sequence[Any], step: Any) -> str:
    if len(set(differences)) == 1:
        return f'The value changes by {differences[0]} and not by {step}.'
    if any(difference < 0 for difference in differences):
        return 'The values start over: the number is set anew although the count goes on.'
    return 'The step changes: does more than one place change the number?'
