"""Seconds of a node's life: what is waited for in real time comes to an end."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from std_msgs.msg import Int16

from labkit.exercises.clauses import Publishes
from labkit.exercises.messages_heard import Lived
from labkit.exercises.observation import ON_THE_WAY, Life, Sent


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


def test_time_line_has_tests_and_what_others_said_in_turn() -> None:
    def said(at: float, value: int, node: str) -> Lived:
        return Lived(Int16(data=value), 0.0, 0, at, node)

    life = Life(30.0, sent=[Sent(float(at), '/odds', {'data': at}) for at in range(1, 20)])
    life.samples['/odds'] = [said(sent.at, sent.fields['data'], '') for sent in life.sent]
    life.samples['/evens'] = [said(at + 0.5, at + 1, '/evener') for at in range(1, 18)]
    line = life.time_line(18.0)
    assert line is not None
    assert {lane: len(moments) for lane, moments in line.lanes.items()} == {
        ('/odds', 'this check'): 19,
        ('/evens', '/evener'): 17,
    }
    shown = [(event.at, event.by, event.text) for event in line.events]
    assert (17.5, '/evener', 'data: 18') in shown and (18.0, 'this check', 'data: 18') in shown
    assert shown == sorted(shown, key=lambda each: each[0])
    assert Life(30.0).time_line(None) is None


def test_time_line_shows_no_character_that_moves_a_terminal() -> None:
    line = SimpleNamespace(name='ear.left', msg='a\x1b[31m b', level=20)
    life = Life(30.0, {'/rosout': [Lived(line, 0.0, 0, 1.0)]})
    told = life.time_line(None)
    assert told is not None
    assert [(event.by, event.text) for event in told.events] == [('/ear/left', 'a?[31m b')]


def test_publishers_are_told_apart_by_what_came_before() -> None:
    left = [(at / 5, number) for at, number in zip(range(150), range(2, 152), strict=True)]
    right = [(-0.1, 2), *((at, number + 1) for at, number in left)]
    samples = [Lived(None, at, number, at) for at, number in sorted([*left, *right])]
    life = Life(30.0, {'/sound': samples})
    found = Publishes('/sound', 5.0, 'std_msgs/msg/String')._right(life)
    numbers = [[sample.number for sample in stream.samples] for stream in found]
    assert sorted(numbers) == [[*range(2, 152)], [*range(3, 153)]]
