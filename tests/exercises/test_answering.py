"""What counts as an answer, or a line: what came before a check began is answered in it, too."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from labkit.exercises import Fail
from labkit.exercises.clauses import Answers, Evidence, Logs, answering
from labkit.exercises.life import Life, Sent
from labkit.exercises.watch import Lived
from labkit.lessons.my_name_is.two_names_clauses import EachAnswers

CLAUSE = Answers('/odds', '/evens', 'add 1', answer=lambda n: n + 1, draw=lambda: [1])
Timed = list[tuple[float, int]]


def evidence(heard: Timed, came: Timed) -> Evidence:
    """Return evidence of half a minute in which these numbers were heard and answered."""

    def samples(numbers: Timed) -> list[Lived]:
        return [Lived(SimpleNamespace(data=value), 0.0, 0, at) for at, value in numbers]

    life = Life(30.0, {'/odds': samples(heard), '/evens': samples(came)})
    ends = {('subscription', '/odds', ''): SimpleNamespace(node='/postman')}
    return Evidence(cast(Any, None), ends=cast(Any, ends), life=life)


def test_answer_to_what_came_before_the_check_is_no_extra_message() -> None:
    seen = evidence([(1.0, 5)], [(0.05, 652), (1.05, 6)])
    assert CLAUSE.judge(seen).startswith('/postman has answered 1 messages')


def test_message_that_answers_nothing_is_one_too_many() -> None:
    with pytest.raises(Fail, match='1 more on /evens'):
        CLAUSE.judge(evidence([(1.0, 5)], [(1.05, 6), (4.0, 652)]))


def test_stranger_who_has_not_found_the_node_takes_no_answer_of_a_test() -> None:
    """The check hears it all the same; it says what a test says, just before it."""
    seen = evidence([(1.9, 5), (2.0, 5)], [(2.05, 6)])
    seen.life.sent = [Sent(2.0, '/odds', {'data': 5})]
    seen.life.strangers = {'/odds': 1}
    assert CLAUSE.judge(seen).startswith('/postman has answered 1 messages')
    seen.life.samples['/evens'].clear()
    with pytest.raises(Fail, match='nothing on /evens'):
        CLAUSE.judge(seen)


def test_one_of_two_who_say_a_name_has_not_been_found_by_a_stranger() -> None:
    def said(*texts: tuple[float, str]) -> list[Lived]:
        return [Lived(SimpleNamespace(data=text), 0.0, 0, at) for at, text in texts]

    opening, other = 'My name is ', 'I am '
    came = [(2.1, opening + 'Bob'), (2.1, opening + 'Ada'), (3.1, other + 'Ada')]
    life = Life(
        30.0,
        {
            '/incomplete': said((1.9, opening), (2.0, opening), (3.0, other)),
            '/names': said(*came, (3.1, other + 'Bob')),
        },
        [Sent(2.0, '/incomplete', {'data': opening}), Sent(3.0, '/incomplete', {'data': other})],
        strangers={'/incomplete': 1},
    )
    ends = {('publisher', '/names', name): SimpleNamespace(node=name) for name in ('/ada', '/bob')}
    seen = Evidence(cast(Any, None), ends=cast(Any, ends), life=life)
    assert EachAnswers().judge(seen).startswith('Each of 2 texts was completed by 2 nodes')
    life.samples['/names'] = said(*came)
    with pytest.raises(Fail, match='Only 1 of 2 nodes answered'):
        EachAnswers().judge(seen)


def test_answer_that_comes_late_is_refused() -> None:
    seen = evidence([(1.0, 5), (2.0, 7)], [(4.0, 6), (4.0, 8)])
    seen.life.sent = [Sent(1.0, '/odds', {'data': 5}), Sent(2.0, '/odds', {'data': 7})]
    with pytest.raises(Fail, match='within 1 s') as refused:
        CLAUSE.judge(seen)
    assert refused.value.seen == '3.0 s from data = 5 to its answer'


def test_answer_to_somebody_else_may_seem_late_because_time_flies() -> None:
    assert CLAUSE.judge(evidence([(1.0, 5)], [(4.0, 6)]))


def test_reason_for_more_messages_names_the_topic_that_is_answered_too() -> None:
    seen = evidence([(1.0, 5), (1.5, 1)], [(1.0, 6), (1.5, 2), (1.6, 2), (2.0, 11)])
    seen.life.sent = [Sent(1.0, '/odds', {'data': 5}), Sent(2.0, '/ones', {'data': 10})]
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(seen)
    assert refused.value.why.startswith('What comes on /ones is answered, too.')


def test_reason_for_the_same_answer_again_and_again_is_a_timer() -> None:
    came = [(1.0 + i / 10, 6) for i in range(5)] + [(2.0 + i / 10, 8) for i in range(5)]
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(evidence([(1.0, 5), (2.0, 7)], came))
    assert refused.value.why.startswith('The answer is repeated')


def test_answer_that_is_left_out_now_and_then_is_still_one_of_a_timer() -> None:
    """Two messages came between two ticks of the timer, so that it has answered the second."""
    heard = [(1.0, 5), (2.0, 7), (2.1, 9), (3.0, 11)]
    came = [
        (at / 2, n) for n, start in ((6, 2), (10, 5), (12, 7)) for at in range(start, start + 5)
    ]
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(evidence(heard, came))
    assert refused.value.why.startswith('The answer is repeated')


def test_message_that_came_too_late_to_be_judged_is_not_called_answered(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(answering, 'hanging', lambda: None)
    heard = [(1.0, 5), (1.5, 7), (29.5, 9)]
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(evidence([(1.0, 5), (29.5, 9)], []))
    assert refused.value.why.endswith('its callback did not publish.')
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(evidence(heard, [(1.05, 6)]))
    assert refused.value.why.startswith('1 of 2 messages were answered rightly')
    seen = evidence(heard, [(1.05, 6), (1.55, 8)])
    assert CLAUSE.judge(seen).startswith('/postman has answered 2 messages')


def lines(heard: list[tuple[float, str]], logged: list[tuple[float, str]]) -> Evidence:
    """Return evidence of half a minute in which these texts were heard, and lines were logged."""
    life = Life(
        30.0,
        {
            '/chatter': [Lived(SimpleNamespace(data=text), 0.0, 0, at) for at, text in heard],
            '/rosout': [
                Lived(SimpleNamespace(name='ear', msg=text), 0.0, 0, at) for at, text in logged
            ],
        },
    )
    ends = {('subscription', '/chatter', ''): SimpleNamespace(node='/ear')}
    return Evidence(cast(Any, None), ends=cast(Any, ends), life=life)


def test_line_about_what_came_before_the_check_is_no_extra_line() -> None:
    clause = Logs('/chatter', 'log it', draw=lambda: ['hello'])
    seen = lines([(2.0, 'hello')], [(0.05, 'from before'), (2.1, 'I heard hello')])
    assert clause.judge(seen) == '/ear logged each of 1 texts in a line.'
    seen = lines([(2.0, 'hello')], [(1.05, 'from nowhere'), (2.1, 'I heard hello')])
    with pytest.raises(Fail, match='1 lines when none had come'):
        clause.judge(seen)


def test_line_about_a_test_is_enough_where_a_stranger_says_the_same() -> None:
    clause = Logs('/chatter', 'log it', draw=lambda: ['hello'])
    seen = lines([(2.0, 'hello'), (2.0, 'hello')], [(2.1, 'I heard hello')])
    with pytest.raises(Fail):
        clause.judge(seen)
    seen.life.sent = [Sent(2.0, '/chatter', {'data': 'hello'})]
    seen.life.strangers = {'/chatter': 1}
    assert clause.judge(seen)
