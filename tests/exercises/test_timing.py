"""Rates in real time, as a busy machine lets them be seen."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import pytest

from labkit.exercises.expect.timing import _fits


def by_a_timer(period: float, late: Sequence[float]) -> list[float]:
    """Return the intervals of a timer whose calls are late, each by so much."""
    called = [index * period + by for index, by in enumerate(late)]
    return [b - a for a, b in pairwise(called)]


@pytest.mark.parametrize(
    'late', [(0,) * 7, (0, 0.3, 0, 0, 0.02, 0, 0), (0.3, 0.3, 0.2, 0.3, 0.28, 0, 0.1)]
)
@pytest.mark.parametrize(('period', 'is_right'), [(0.5, True), (0.6, False), (0.4, False)])
def test_a_call_that_was_late_does_not_make_another_rate(
    period: float, is_right: bool, late: Sequence[float]
) -> None:
    assert _fits(by_a_timer(period, late), 0.5, at_least=False) is is_right


def test_a_sleep_that_lasts_longer_now_and_then_is_no_slower_rate() -> None:
    slept = [0.5 + more for more in (0.01, 0.04, 0.02, 0.3, 0.2, 0.4)]
    assert _fits(slept, 0.5, at_least=False)
    assert not _fits([0.1 + gap for gap in slept], 0.5, at_least=False)


def test_more_is_right_where_the_task_says_at_least() -> None:
    assert _fits([0.2] * 6, 0.5, at_least=True) and not _fits([0.6] * 6, 0.5, at_least=True)
