"""The draws of each exercise find out the programs that are wrong in the usual ways.

A program is a function here, see `wrong_programs`. So hundreds of checks take a second, and no
node is needed.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from itertools import pairwise
from types import SimpleNamespace
from typing import Any, cast

import pytest
from wrong_programs import CLAUSES, Program, Rule, Timed, by_a_timer, each, rule_of, table

from labkit.exercises import Fail
from labkit.exercises.clauses import Answers, Evidence, Logs, answering, base, logs
from labkit.exercises.draws import (
    KNOWN,
    draw_int16s,
    draw_names,
    draw_outside,
    draw_size,
    draw_texts,
    filled,
)
from labkit.exercises.messages_heard import Lived, build
from labkit.exercises.observation import Life, Sent
from labkit.exercises.what_is_asked import Scope

NODE = '/node'
SEEDS = range(12)


@pytest.fixture
def alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a clause draw its tests without a node."""
    for module in (answering, logs):
        monkeypatch.setattr(module, 'spun', lambda probe, end: None)
        monkeypatch.setattr(module, 'hanging', lambda: None)
    monkeypatch.setattr(answering, '_others', lambda probe, hears: [])


def judged(clause: Answers | Logs, program: Program, seed: int) -> str:
    """Return what a clause says of a program that has got its tests, at drawn times."""
    random.seed(seed)
    inner = clause.topic if isinstance(clause, Logs) else clause.inner
    by = '' if isinstance(clause, Logs) else clause.by
    end = SimpleNamespace(node=NODE, msg_type=clause.msg_type)
    probe: Any = SimpleNamespace(
        scope=Scope(), publishers=lambda topic: [], node_object=lambda name: None
    )
    seen = Evidence(probe, ends=cast(Any, {('subscription', inner, by): end}))
    # Not what a stage of one exercise has besides: it lets its node live once more.
    kind = Logs if isinstance(clause, Logs) else Answers
    tests = base._in_turn(kind.tests(cast(Any, clause), seen))
    values = [
        test.fields[clause.field] if isinstance(clause, Logs) else clause._heard_of(test.fields)
        for test in tests
    ]
    heard = list(zip([test.at for test in tests], values, strict=True))
    said = [(at, v) for at, v in program(heard, lambda: rule_of(clause)) if v is not None]
    sent = [Lived(build(test.msg_type, test.fields), 0.0, 0, test.at) for test in tests]
    if isinstance(clause, Logs):
        outer = '/rosout'
        came = [Lived(SimpleNamespace(name=NODE[1:], msg=v), 0.0, 0, at) for at, v in said]
    else:
        outer, outer_type = clause.outer, clause.outer_type or clause.msg_type
        came = [
            Lived(build(outer_type, {clause._says: v}), 0.0, number, at, NODE)
            for number, (at, v) in enumerate(said, start=1)
        ]
    samples = {inner: sent, outer: came}
    if inner == outer:
        samples = {inner: sorted([*sent, *came], key=lambda sample: sample.at)}
    seen.life = Life(base._seconds(tests), samples)
    seen.life.sent = [Sent(test.at, test.topic, test.fields) for test in tests]
    return kind.judge(cast(Any, clause), seen)


@pytest.mark.usefixtures('alone')
@pytest.mark.parametrize('program', [each, by_a_timer])
@pytest.mark.parametrize('name', CLAUSES)
def test_right_program_is_right_whatever_is_drawn(name: str, program: Program) -> None:
    for seed in SEEDS:
        assert judged(CLAUSES[name], program, seed)


@pytest.mark.usefixtures('alone')
@pytest.mark.parametrize(
    ('name', 'what'), [(name, what) for name, c in CLAUSES.items() for what in table(name, c)]
)
def test_wrong_program_is_found_out_whatever_is_drawn(name: str, what: str) -> None:
    for seed in SEEDS:
        with pytest.raises(Fail):
            judged(CLAUSES[name], table(name, CLAUSES[name])[what], seed)


@pytest.mark.usefixtures('alone')
@pytest.mark.parametrize('name', CLAUSES)
def test_answer_that_comes_after_that_time_is_refused(name: str) -> None:
    def late(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
        return [(at + 1.01 * answering.WITHIN_SEC, said) for at, said in each(heard, fresh)]

    with pytest.raises(Fail):
        judged(CLAUSES[name], late, 0)


@pytest.mark.parametrize('seed', SEEDS)
def test_traps_are_drawn_each_time(seed: int) -> None:
    random.seed(seed)
    numbers = draw_int16s(-7, 2001, 2)
    assert {-7, -5, -1, 1, 1999, 2001} <= {*numbers}
    assert all(-7 <= n <= 2001 and n % 2 for n in numbers)
    assert {0, -1, 1, -32768, 32767} <= {*draw_int16s()}
    texts = draw_texts()
    assert '' in texts
    assert any(text.isspace() for text in texts)
    assert any(text.count(': ') > 1 for text in texts)
    assert any(text != text.strip() for text in texts)
    assert any('  ' in text.strip() for text in texts)
    assert max(map(len, texts)) > 2000
    assert any(text.startswith(KNOWN) for text in texts)
    assert not all(map(str.isascii, texts))
    assert all(text.strip() for text in draw_texts(empty=False))
    for values in (numbers, texts):
        assert sum(a == b for a, b in pairwise(cast(Any, values))) > 1
        assert values[0] == values[-1]
    names = draw_names(12)
    assert len({*names, *draw_names()}) == 21
    assert any(a != b and a.lower() == b.lower() for a in names for b in names)


@pytest.mark.parametrize('seed', SEEDS)
def test_what_lies_outside_of_a_range_is_near_and_far(seed: int) -> None:
    random.seed(seed)
    outside = draw_outside(1, 20)
    assert {0, 21, -(2**31), 2**31 - 1} <= {*outside}
    assert not any(1 <= n <= 20 for n in outside)
    assert outside == sorted(outside, key=abs)
    for size in (100, 256, 1000, 65536):
        assert any(1 <= n % size <= 20 for n in outside)
    assert any(1 <= abs(n) <= 20 for n in outside)
    assert any(n < 0 for n in draw_outside(0, 5))
    assert all(0.01 <= draw_size(0.01, 10) <= 10 for _ in range(50))


def test_each_field_that_no_task_names_is_filled() -> None:
    fields = filled('nav_msgs/msg/Odometry', {'pose.pose.position.x': 0.0})
    assert fields['pose.pose.position.x'] == 0.0
    given = {*fields} - {'pose.pose.position.x'}
    assert {'header.stamp.sec', 'pose.pose.position.z', 'twist.twist.angular.z'} <= given
    assert all(fields[name] for name in given)
    message = build('nav_msgs/msg/Odometry', fields)
    assert message.pose.pose.position.z == fields['pose.pose.position.z']
