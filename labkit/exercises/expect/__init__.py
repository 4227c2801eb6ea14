"""The matchers of a check, under one name: `from labkit.exercises import expect`.

Each looks at one thing. It returns what was found, or raises the outcome: `Fail` with what was
expected, what was seen, the misconception and the next step, or `NotAttempted`.
"""

from __future__ import annotations

from labkit.exercises.expect.endpoints import alone, node, publisher, qos, subscription
from labkit.exercises.expect.services import asks, only_given, server
from labkit.exercises.expect.spinning import hanging, overloaded, spun
from labkit.exercises.expect.timing import ends_with_node, messages
from labkit.exercises.expect.values import apart, digits, show, text_trouble
from labkit.exercises.mistakes import Mistake
from labkit.exercises.verdict import Fail

__all__ = [
    'alone',
    'apart',
    'asks',
    'digits',
    'ends_with_node',
    'hanging',
    'messages',
    'node',
    'only_given',
    'overloaded',
    'publisher',
    'qos',
    'server',
    'show',
    'spun',
    'subscription',
    'text_trouble',
    'that',
]


def that(
    condition: object,
    *,
    expected: str,
    seen: str,
    mistake: Mistake | None = None,
) -> None:
    """Expect anything else.

    Args:
        condition: Whether it is so.
        expected: What should have been observed.
        seen: What was observed.
        mistake: The likely misconception.

    Raises:
        Fail: It is not so.
    """
    if not condition:
        raise Fail(expected, seen, mistake)
