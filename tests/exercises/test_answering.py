"""What counts as an answer: what came before a check began is answered in it, too."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from labkit.exercises import Fail
from labkit.exercises.clauses import Answers, Evidence
from labkit.exercises.life import Life
from labkit.exercises.watch import Sample

CLAUSE = Answers('/odds', '/evens', 'add 1', answer=lambda n: n + 1, draw=lambda: [1])
Timed = list[tuple[float, int]]


def evidence(heard: Timed, came: Timed) -> Evidence:
    """Return evidence of half a minute in which these numbers were heard and answered."""

    def samples(numbers: Timed) -> list[Sample]:
        return [Sample(SimpleNamespace(data=value), 0.0, 0, at) for at, value in numbers]

    life = Life(30.0, {'/odds': samples(heard), '/evens': samples(came)})
    ends = {('subscription', '/odds', ''): SimpleNamespace(node='/postman')}
    return Evidence(cast(Any, None), ends=cast(Any, ends), life=life)


def test_answer_to_what_came_before_the_check_is_no_extra_message() -> None:
    seen = evidence([(1.0, 5)], [(0.05, 652), (1.05, 6)])
    assert CLAUSE.judge(seen).startswith('/postman has answered 1 messages')


def test_message_that_answers_nothing_is_one_too_many() -> None:
    with pytest.raises(Fail, match='1 more on /evens'):
        CLAUSE.judge(evidence([(1.0, 5)], [(1.05, 6), (4.0, 652)]))
