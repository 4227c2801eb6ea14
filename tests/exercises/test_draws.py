"""The draws of each exercise find out the programs that are wrong in the usual ways.

A program is a function here: it gets the tests with the times at which they are sent, and returns
what it says. So hundreds of checks take a second, and no node is needed.
"""

from __future__ import annotations

import inspect
import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace
from typing import Any, cast

import pytest

from labkit.exercises import Fail
from labkit.exercises.clauses import Answers, Evidence, Logs, answering, base, logs
from labkit.exercises.draws import (
    draw_int16s,
    draw_names,
    draw_texts,
    filled,
)
from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.messages_heard import Lived, build
from labkit.exercises.observation import Life, Sent
from labkit.exercises.what_is_asked import Scope

Timed = list[tuple[float, Any]]
Rule = Callable[[Any], Any]
Program = Callable[[Timed, Callable[[], Rule]], Timed]

NODE = '/node'
SEEDS = range(12)
# Answers of these take time of their own, or belong to a service.
OTHERWISE = ('asker', 'porter')

CLAUSES: dict[str, Answers | Logs] = {
    exercise.name: clause
    for lesson in all_lessons()
    for exercise in lesson.exercises
    for clause in exercise.clauses
    if isinstance(clause, (Answers, Logs)) and exercise.name not in OTHERWISE
}
# The learner makes its type; here stands one for it that is there.
CLAUSES['leg'] = replace(
    cast(Answers, CLAUSES['leg']), msg_type='geometry_msgs/msg/Vector3', field='x'
)


def rule_of(clause: Answers | Logs) -> Rule:
    """Return what a right program says for a value; one with a memory begins anew."""
    if isinstance(clause, Logs):
        return clause.line or str
    if not inspect.isgeneratorfunction(clause.answer):
        return clause.answer
    node = clause.answer(None)
    next(node)
    return node.send


def each(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
    rule = fresh()
    return [(at, rule(value)) for at, value in heard]


def by_a_timer(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
    return [(at + 0.1 - at % 0.1, said) for at, said in each(heard, fresh)]


def those(keep: Callable[[int, Timed], bool]) -> Program:
    """Return a program that leaves messages out: `keep` gets which one it is, and all of them."""
    return lambda heard, fresh: each([p for i, p in enumerate(heard) if keep(i, heard)], fresh)


def leaves_out(number: int) -> Program:
    """Return a program that leaves out every `number`-th answer."""

    def program(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
        said = [pair for pair in each(heard, fresh) if pair[1] is not None]
        return [pair for i, pair in enumerate(said, start=1) if i % number]

    return program


def changed(change: Callable[[Any], Any]) -> Program:
    """Return a program that does not take a message as it is."""
    return lambda heard, fresh: each([(at, change(value)) for at, value in heard], fresh)


def limited(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
    kept: Timed = []
    for at, value in heard:
        if not kept or at - kept[-1][0] >= 0.3:
            kept.append((at, value))
    return each(kept, fresh)


def newest(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
    """Answer the newest only, every 0.4 s."""
    ticks = [0.4 * i + 0.123 for i in range(200)]
    kept = [
        (end, [value for at, value in heard if begin < at <= end][-1])
        for begin, end in pairwise(ticks)
        if any(begin < at <= end for at, _ in heard)
    ]
    return each(kept, fresh)


def forgetful(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
    """Begin anew after ten messages."""
    return [pair for i in range(0, len(heard), 10) for pair in each(heard[i : i + 10], fresh)]


def twice(heard: Timed, fresh: Callable[[], Rule]) -> Timed:
    return [pair for pair in each(heard, fresh) for _ in range(2)]


WRONG: dict[str, Program] = {
    'not the same again': those(lambda i, heard: not i or heard[i][1] != heard[i - 1][1]),
    'not what came before': those(lambda i, heard: heard[i][1] not in [v for _, v in heard[:i]]),
    'not the same within 10 ms': those(
        lambda i, heard: (
            not i or heard[i][1] != heard[i - 1][1] or heard[i][0] > heard[i - 1][0] + 0.01
        )
    ),
    'the rate is limited': limited,
    'the newest every 0.4 s': newest,
    'the first one only': those(lambda i, heard: i < 1),
    'the first ten only': those(lambda i, heard: i < 10),
    'the first twenty only': those(lambda i, heard: i < 20),
    'not the first': those(lambda i, heard: i > 0),
    'every other': leaves_out(2),
    'all but every fifth': leaves_out(5),
    'nothing for nothing': those(lambda i, heard: bool(heard[i][1])),
    'twice': twice,
}
TEXTS: dict[str, Program] = {
    'one blank between two words': changed(lambda text: ' '.join(text.split())),
    'no blanks at the ends': changed(str.strip),
    'small letters': changed(str.lower),
    'the first 20 letters': changed(lambda text: text[:20]),
    'letters of English': changed(lambda text: text.encode('ascii', 'ignore').decode()),
    'the last part': changed(lambda text: text.rpartition(': ')[2]),
}
NUMBERS: dict[str, Program] = {
    'not the least': those(lambda i, heard: heard[i][1] != min(v for _, v in heard)),
    'not the largest': those(lambda i, heard: heard[i][1] != max(v for _, v in heard)),
    'no sign': changed(lambda n: -n if -9999 < n < 0 else n),
    'small numbers': changed(lambda n: max(-9999, min(9999, n))),
    'off by one at the lower edge': changed(lambda n: n + 1 if n < -32760 or n == 0 else n),
}
# What makes no difference in a task: it is none of the wrong ones there.
SAME = {
    'evens': {'nothing for nothing'},
    'two_stages': {'it forgets after ten'},
    'mouth': {'small letters'},
    'greeter': {
        'nothing for nothing',
        'one blank between two words',
        'no blanks at the ends',
        'letters of English',
    },
    'polite': {
        'nothing for nothing',
        'no blanks at the ends',
        'not the same again',
        'not what came before',
        'not the same within 10 ms',
    },
    'distance': {'nothing for nothing'},
}
MEMORY: dict[str, Program] = {'it forgets after ten': forgetful}


def table(name: str, clause: Answers | Logs) -> dict[str, Program]:
    first = drawn(clause)[0]
    found = dict(WRONG)
    if isinstance(first, str):
        found.update(TEXTS)
    if isinstance(first, int):
        found.update(NUMBERS)
    if isinstance(clause, Answers) and inspect.isgeneratorfunction(clause.answer):
        found.update(MEMORY)
    return {what: program for what, program in found.items() if what not in SAME.get(name, ())}


def drawn(clause: Answers | Logs) -> Sequence[Any]:
    return clause.draw() if isinstance(clause, Logs) else clause._drawn()


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
    assert max(map(len, texts)) > 200
    assert not all(map(str.isascii, texts))
    assert all(text.strip() for text in draw_texts(empty=False))
    for values in (numbers, texts):
        assert sum(a == b for a, b in pairwise(cast(Any, values))) > 1
        assert values[0] == values[-1]
    names = draw_names(12)
    assert len({*names, *draw_names()}) == 21
    assert any(a != b and a.lower() == b.lower() for a in names for b in names)


def test_each_field_that_no_task_names_is_filled() -> None:
    fields = filled('nav_msgs/msg/Odometry', {'pose.pose.position.x': 0.0})
    assert fields['pose.pose.position.x'] == 0.0
    given = {*fields} - {'pose.pose.position.x'}
    assert {'header.stamp.sec', 'pose.pose.position.z', 'twist.twist.angular.z'} <= given
    assert all(fields[name] for name in given)
    message = build('nav_msgs/msg/Odometry', fields)
    assert message.pose.pose.position.z == fields['pose.pose.position.z']
