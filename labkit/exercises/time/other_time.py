"""Code of the notebook that goes by a time which a check can't move: see `learner_time`."""

from __future__ import annotations

import asyncio
import datetime
import dis
import select
import selectors
from collections.abc import Iterator, Mapping
from types import CodeType, FunctionType
from typing import Any

__all__ = ['other_times']

# What tells the time or waits for it, and what of it a program uses then; nothing for any use.
_UNMOVED: Mapping[str, tuple[tuple[Any, ...], frozenset[str]]] = {
    'datetime': (
        (datetime, datetime.datetime, datetime.date),
        frozenset(('now', 'utcnow', 'today')),
    ),
    'asyncio': ((asyncio,), frozenset(('wait', 'wait_for', 'timeout', 'timeout_at'))),
    'select': ((select, select.select, selectors), frozenset()),
}
_OF_A_LOOP = frozenset(('call_later', 'call_at'))


def other_times(space: Mapping[str, Any]) -> list[str]:
    """Return which functions of a namespace go by such a time, as `'on_timer (datetime)'`.

    Args:
        space: What the cells have defined, by its names.
    """
    found = {
        f'{function.__name__} ({by})': None
        for function in _functions(space)
        for by in _unmoved(function.__code__, function.__globals__)
    }
    return list(found)


def _functions(space: Mapping[str, Any]) -> Iterator[FunctionType]:
    for thing in list(space.values()):
        if isinstance(thing, (FunctionType, type)) and thing.__module__ == '__main__':
            inside = list(vars(thing).values()) if isinstance(thing, type) else [thing]
            yield from (each for each in inside if isinstance(each, FunctionType))


def _unmoved(code: CodeType, known: Mapping[str, Any]) -> Iterator[str]:
    if _OF_A_LOOP.intersection(code.co_names):
        yield 'asyncio'
    for name, *parts in _paths(code):
        for by, (things, used) in _UNMOVED.items():
            is_it = name in known and any(known[name] is thing for thing in things)
            if is_it and (not used or used.intersection(parts)):
                yield by
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _unmoved(inner, known)


def _paths(code: CodeType) -> Iterator[list[str]]:
    """Give what code reads of global things: `['datetime', 'datetime', 'now']`."""
    path: list[str] = []
    for step in dis.get_instructions(code):
        if step.opname in ('LOAD_ATTR', 'LOAD_METHOD') and path:
            path.append(step.argval)
            continue
        if path:
            yield path
        path = [step.argval] if step.opname in ('LOAD_GLOBAL', 'LOAD_NAME') else []
