"""Seconds of a node's life: what is waited for in real time comes to an end."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from labkit.exercises.life import ON_THE_WAY, Life, Sent, _Course
from labkit.exercises.watch import Lived


class Endless:
    """A topic on which one more message has come each time that somebody looks."""

    def __init__(self) -> None:
        self.count = 0

    def pump(self) -> None:
        self.count += 1
        assert self.count < 500, 'still waiting'

    def __len__(self) -> int:
        return self.count


def test_a_topic_that_is_never_quiet_is_not_waited_for_without_an_end():
    """A sensor that the lesson gives publishes on, in real time."""
    topic = Endless()
    probe: Any = SimpleNamespace(look=lambda seconds: None)
    passing: Any = SimpleNamespace(seconds=30.0)
    watches: Any = {'/range': topic}
    course = _Course(probe, passing, watches, moments=[], until=None)
    course.wait_for_late_ones()
    assert topic.count


@pytest.mark.parametrize(
    ('strangers', 'unknown', 'left'),
    [(0, 0, ['known']), (0, 1, ['known', 'odd 0']), (1, ON_THE_WAY, ['known'])],
)
def test_what_may_be_said_upon_messages_of_others_is_left_out(
    strangers: int, unknown: int, left: list[str]
) -> None:
    life = Life(strangers={'/range': strangers})
    extra = [(1.0, 'known'), *((2.0, f'odd {number}') for number in range(unknown))]
    found = life.without_strangers('/range', extra, {'known', 'other'})
    assert [value for _, value in found] == left


def test_what_is_said_more_often_than_others_speak_counts() -> None:
    life = Life(strangers={'/range': 1, '/other': 9})
    extra = [(float(number), f'odd {number}') for number in range(ON_THE_WAY + 1)]
    assert life.without_strangers('/range', extra, set()) == extra
    # Where two nodes answer, so many may have come upon what others have sent.
    assert not life.without_strangers('/range', extra, set(), answers=2)


def test_what_a_stranger_sends_is_not_due_and_comes_last() -> None:
    """It may not have found the node yet, or be on its way when time ends."""
    stranger, test, late = (
        Lived(SimpleNamespace(data=data), 999.9, 0, at)
        for data, at in (('hello', 1.0), ('test', 2.0), ('hello', 29.5))
    )
    life = Life(
        seconds=30.0,
        samples={'/range': [stranger, test, late]},
        sent=[Sent(2.0, '/range', {'data': 'test'})],
        strangers={'/range': 1},
    )
    assert life.heard('/range', 1.0) == [(test, True), (stranger, False), (late, False)]
    life.strangers = {}
    assert life.heard('/range', 1.0) == [(stranger, True), (test, True), (late, False)]


@pytest.mark.parametrize('text', ['hello', 'test'])
def test_a_message_of_a_stranger_in_the_moment_of_a_test_is_no_test(text: str) -> None:
    test, stranger = (Lived(SimpleNamespace(data=data), 999.9, 0, 2.0) for data in ('test', text))
    life = Life(
        seconds=30.0,
        samples={'/range': [test, stranger]},
        sent=[Sent(2.0, '/range', {'data': 'test'})],
        strangers={'/range': 1},
    )
    assert life.heard('/range', 1.0) == [(test, True), (stranger, False)]
