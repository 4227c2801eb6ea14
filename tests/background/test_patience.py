"""How long an answer may take: longer on a busy machine, and longer in a long session."""

from __future__ import annotations

import os

import pytest

from labkit.background import patience


@pytest.fixture(autouse=True)
def two_processors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, 'cpu_count', lambda: 2)


@pytest.mark.parametrize(
    ('load', 'times'), [(0.0, 1.0), (2.0, 1.0), (4.0, 2.0), (6.0, 3.0), (90.0, 3.0)]
)
def test_a_busy_machine_is_given_more_time(
    monkeypatch: pytest.MonkeyPatch, load: float, times: float
) -> None:
    monkeypatch.setattr(os, 'getloadavg', lambda: (load, 0.0, 0.0))
    monkeypatch.setattr(patience.made, 'count', 0)
    assert patience.busyness() == times
    assert patience.answer_sec(2.0) == 2.0 * times


def test_each_node_that_was_ever_made_adds_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, 'getloadavg', lambda: (0.0, 0.0, 0.0))
    monkeypatch.setattr(patience.made, 'count', 900)
    # Measured: 6.8 s.
    assert patience.answer_sec(1.0) == 10.0
    monkeypatch.setattr(patience.made, 'count', 10**6)
    assert patience.answer_sec(1.0) == patience.MOST_SEC
