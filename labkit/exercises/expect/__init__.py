"""The matchers of a check, under one name: `from labkit.exercises import expect`.

Each looks at one thing. It returns what was found, or raises the outcome: `Fail` with what was
expected, what was seen, the misconception and the next step, or `NotAttempted`.
"""

from __future__ import annotations

from labkit.exercises.expect.endpoints import alone, node, publisher, qos, subscription
from labkit.exercises.expect.services import server
from labkit.exercises.expect.spinning import hanging, spun
from labkit.exercises.expect.timing import describe_rate, ends_with_node, messages, rate
from labkit.exercises.expect.values import (
    each,
    equal,
    first,
    show,
    steps,
    text_trouble,
)
from labkit.exercises.verdict import Fail

__all__ = [
    'alone',
    'describe_rate',
    'each',
    'ends_with_node',
    'equal',
    'first',
    'hanging',
    'messages',
    'node',
    'publisher',
    'qos',
    'rate',
    'server',
    'show',
    'spun',
    'steps',
    'subscription',
    'text_trouble',
    'that',
]


def that(condition: object, *, expected: str, seen: str, why: str = '', todo: str = '') -> None:
    """Expect anything else.

    Args:
        condition: Whether it is so.
        expected: What should have been observed.
        seen: What was observed.
        why: The likely misconception.
        todo: The next step.

    Raises:
        Fail: It is not so.
    """
    if not condition:
        raise Fail(expected, seen, why=why, todo=todo)
