"""Answers and log lines: those to messages from before the check count, too."""

from __future__ import annotations

import threading
from collections.abc import Generator
from dataclasses import replace
from functools import partial
from types import ModuleType, SimpleNamespace
from typing import Any, cast

import pytest
from rclpy.node import Node
from std_msgs.msg import Int16

from labkit.exercises import Fail, Probe, common_mistakes
from labkit.exercises.clauses import Answers, Evidence, Logs, Says, Stream, answering
from labkit.exercises.messages_heard import Lived, Watch
from labkit.exercises.mistakes import Mistake
from labkit.exercises.observation import Life, Sent, Stimulus, live
from labkit.exercises.what_is_asked import Scope

INT16 = 'std_msgs/msg/Int16'
CLAUSE = Answers('/odds', '/evens', INT16, 'add 1', answer=lambda n: n + 1, draw=lambda: [1])
Timed = list[tuple[float, int]]
# The probe where no node but the one that answers has an end.
NOBODY_ELSE: Any = SimpleNamespace(
    scope=Scope(), publishers=lambda topic: [], node_object=lambda name: None
)


def evidence(heard: Timed, came: Timed) -> Evidence:
    """Return evidence of half a minute with these numbers and answers."""

    def samples(numbers: Timed) -> list[Lived]:
        return [Lived(SimpleNamespace(data=value), 0.0, 0, at) for at, value in numbers]

    life = Life(30.0, {'/odds': samples(heard), '/evens': samples(came)})
    ends = {('subscription', '/odds', ''): SimpleNamespace(node='/postman')}
    return Evidence(NOBODY_ELSE, ends=cast(Any, ends), life=life)


def test_answer_to_what_came_before_the_check_is_no_extra_message() -> None:
    seen = evidence([(1.0, 5)], [(0.05, 652), (1.05, 6)])
    assert CLAUSE.judge(seen).startswith('/postman has answered 1 message,')


def test_answer_to_what_came_as_time_began_is_no_extra_message(lab: ModuleType) -> None:
    """Another node goes on in real time, as a stage that hears another process does."""

    class Postman(Node):
        def __init__(self) -> None:
            super().__init__('postman')
            self.publisher = self.create_publisher(Int16, 'evens', 10)
            self.create_subscription(Int16, 'odds', self.on_odd, 10)

        def on_odd(self, msg: Int16) -> None:
            sum(range(1_000_000))  # time begins meanwhile
            self.publisher.publish(Int16(data=msg.data + 1))

    other = Node('other')
    speaks = other.create_publisher(Int16, 'odds', 10)
    lab.spin(other)
    lab.spin(Postman())
    topics = {'/odds': INT16, '/evens': INT16}
    test = Stimulus(1.0, '/odds', INT16, {'data': 5}, ['/evens'])
    with Probe('evens', Scope(publishes=topics)) as probe:
        life = live(
            probe,
            topics,
            5.0,
            stimuli=[test],
            nodes={'/postman'},
            before=lambda passing: speaks.publish(Int16(data=7)),
        )
    ends: Any = {('subscription', '/odds', ''): SimpleNamespace(node='/postman')}
    assert [s.message.data for s in life.on('/odds')] == [5]
    said = CLAUSE.judge(Evidence(NOBODY_ELSE, ends=ends, life=life))
    assert said.startswith('/postman has answered 2 messages')


def test_message_whose_answer_is_not_seen_is_left_out(
    lab: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It came when the check listened to the one topic, and not yet to the other."""
    answered = threading.Event()

    class Postman(Node):
        def __init__(self) -> None:
            super().__init__('postman')
            self.publisher = self.create_publisher(Int16, 'evens', 10)
            self.create_subscription(Int16, 'odds', self.on_odd, 10)

        def on_odd(self, msg: Int16) -> None:
            self.publisher.publish(Int16(data=msg.data + 1))
            answered.set()

    speaks = Node('other').create_publisher(Int16, 'odds', 10)
    lab.spin(Postman())
    listen = Probe.watch

    def listen_meanwhile(probe: Probe, topic: str, *names: str) -> Watch:
        watch = listen(probe, topic, *names)
        if topic == '/odds':
            speaks.publish(Int16(data=7))
            assert answered.wait(60)
        return watch

    monkeypatch.setattr(Probe, 'watch', listen_meanwhile)
    topics = {'/odds': INT16, '/evens': INT16}
    test = Stimulus(1.0, '/odds', INT16, {'data': 5}, ['/evens'])
    with Probe('evens', Scope(publishes=topics)) as probe:
        life = live(probe, topics, 3.0, stimuli=[test], nodes={'/postman'})
    (before,) = [s for s in life.on('/odds', before=True) if s.at < 0]
    assert (before.message.data, before.at < life.since < 0) == (7, True)


def test_memory_begins_where_answers_are_seen() -> None:
    def total(before: int) -> Generator[int, int, None]:
        while True:
            before += yield before

    clause = with_memory(total, resume=lambda value, said: [said - value])
    seen = evidence([(-0.2, 3), (1.0, 5), (2.0, 1)], [(1.1, 8), (2.1, 9)])
    seen.life.since = -0.1
    assert clause.judge(seen)


def test_node_of_each_message_of_this_process_is_known(lab: ModuleType) -> None:
    class Postman(Node):
        def __init__(self, name: str) -> None:
            super().__init__(name)
            self.publisher = self.create_publisher(Int16, 'evens', 10)
            self.create_subscription(Int16, 'odds', self.pass_on, 10)

        def pass_on(self, msg: Int16) -> None:
            self.publisher.publish(msg)

    for name in ('ann', 'ben'):
        lab.spin(Postman(name))
    topics = {'/odds': INT16, '/evens': INT16}
    tests = [Stimulus(at, '/odds', INT16, {'data': 5}, ['/evens']) for at in (1.0, 1.005)]
    with Probe('evens', Scope(publishes=topics)) as probe:
        life = live(probe, topics, 2.0, stimuli=tests, nodes={'/ann', '/ben'})
    said = sorted((round(sample.at, 3), sample.node) for sample in life.on('/evens'))
    assert said == [(at, node) for at in (1.0, 1.005) for node in ('/ann', '/ben')]
    assert not {sample.node for sample in life.on('/odds')} & {'/ann', '/ben'}


def test_message_that_answers_nothing_is_one_too_many() -> None:
    with pytest.raises(Fail, match='1 more on /evens'):
        CLAUSE.judge(evidence([(1.0, 5)], [(1.05, 6), (4.0, 652)]))


def test_late_answer_to_what_was_sent_before_time_passed_is_no_extra_message() -> None:
    seen = evidence([(1.0, 5)], [(1.05, 6), (4.0, 652)])
    seen.asked = {'/odds': [{'data': 651}]}
    assert CLAUSE.judge(seen).startswith('/postman has answered 1 message,')


def test_stranger_who_has_not_found_the_node_takes_no_answer_of_a_test() -> None:
    """The check hears it all the same; it says what a test says, just before it."""
    seen = evidence([(1.9, 5), (2.0, 5)], [(2.05, 6)])
    seen.life.sent = [Sent(2.0, '/odds', {'data': 5})]
    seen.life.strangers = {'/odds': 1}
    assert CLAUSE.judge(seen).startswith('/postman has answered 1 message,')
    seen.life.samples['/evens'].clear()
    with pytest.raises(Fail, match='nothing on /evens'):
        CLAUSE.judge(seen)


def test_answer_to_a_stranger_who_speaks_with_a_test_may_seem_late() -> None:
    seen = evidence([(1.0, 5), (1.0, 5)], [(1.0, 6), (4.0, 6)])
    seen.life.sent = [Sent(1.0, '/odds', {'data': 5})]
    seen.life.strangers = {'/odds': 1}
    assert CLAUSE.judge(seen).startswith('/postman has answered 2 messages')


def test_answer_that_comes_late_is_refused() -> None:
    seen = evidence([(1.0, 5), (2.0, 7)], [(4.0, 6), (4.0, 8)])
    seen.life.sent = [Sent(1.0, '/odds', {'data': 5}), Sent(2.0, '/odds', {'data': 7})]
    with pytest.raises(Fail, match='within 1 s') as refused:
        CLAUSE.judge(seen)
    assert refused.value.seen == '3.0 s from data = 5 to its answer'
    seen.life.real = seen.life.lost = ['/postman']
    with pytest.raises(Fail, match='within 1 s'):
        CLAUSE.judge(seen)
    seen.life.lost = ()
    assert CLAUSE.judge(seen)


def test_answer_to_somebody_else_may_seem_late_because_time_flies() -> None:
    assert CLAUSE.judge(evidence([(1.0, 5)], [(4.0, 6)]))


def test_reason_for_more_messages_names_the_topic_that_is_answered_too() -> None:
    seen = evidence([(1.0, 5), (1.5, 1)], [(1.0, 6), (1.5, 2), (1.6, 2), (2.0, 11)])
    seen.life.sent = [Sent(1.0, '/odds', {'data': 5}), Sent(2.0, '/ones', {'data': 10})]
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(seen)
    assert refused.value.why.startswith('What comes on /ones is answered, too.')


def test_reason_in_a_text_is_seen_beside_the_answer_to_somebody_else() -> None:
    """A stage answers what the other stages say, too, now and then together with a test."""
    clause = Answers('/odds', '/evens', 'std_msgs/msg/String', '', answer='{}.'.format)
    seen = evidence(*cast(Any, ([(1.0, 'Zoe'), (1.002, 'Ada')], [(1.005, 'Zoe'), (1.006, 'Ada')])))
    with pytest.raises(Fail) as refused:
        clause.judge(seen)
    assert refused.value.why.startswith("The text ends too early: '.' is missing.")


def test_echo_is_the_reason_though_somebody_else_spoke_in_between() -> None:
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(evidence([(1.0, 5), (1.0, 20)], [(1.0, 5), (1.0, 6), (1.0, 21)]))
    assert refused.value.why.startswith('The input is published too')


def test_reason_for_the_same_answer_again_and_again_is_a_timer() -> None:
    came = [(1.0 + i / 10, 6) for i in range(5)] + [(2.0 + i / 10, 8) for i in range(5)]
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(evidence([(1.0, 5), (2.0, 7)], came))
    assert refused.value.why.startswith('The answer is repeated')


def test_timer_that_misses_most_messages_is_still_the_reason() -> None:
    heard = [(n / 6, n) for n in range(6, 174)]
    ticks = [1.1 + i / 2 + more for i in range(57) for more in (0.0, 0.01, 0.02, 0.03)]
    came = [(at, 1 + max(n for t, n in heard if t < at)) for at in ticks]
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(evidence(heard, came))
    assert refused.value.why.startswith('The answer is repeated')


def test_answer_to_a_stranger_between_is_no_reason_against_a_timer() -> None:
    """When a stranger was heard is not known: the node may have heard it later."""
    heard = [(1.0, 5), (1.9, 21), (2.0, 7), (2.1, 9), (3.0, 11)]
    came = [(1.4, 6), (1.6, 6), (1.8, 6), (1.95, 6), (2.05, 22), (2.4, 10), (2.6, 10), (3.1, 12)]
    seen = evidence(heard, came)
    seen.life.sent = [Sent(at, '/odds', {'data': n}) for at, n in heard if n != 21]
    seen.life.strangers = {'/odds': 1}
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(seen)
    assert refused.value.why.startswith('The answer is repeated')


def test_stranger_who_repeats_a_test_may_have_said_it_once_more() -> None:
    """The check may know the stranger later than the node does."""
    heard = [(1.0, 5), (1.4, 5), (2.0, 7)]
    came = [(1.0, 6), (1.4, 6), (1.8, 6), (2.0, 8)]
    seen = evidence(heard, came)
    seen.life.sent = [Sent(1.0, '/odds', {'data': 5}), Sent(2.0, '/odds', {'data': 7})]
    seen.life.strangers = {'/odds': 1}
    assert CLAUSE.judge(seen)
    with pytest.raises(Fail, match='answered more than once'):
        CLAUSE.judge(evidence(heard, came))


def test_stranger_may_be_heard_after_several_tests() -> None:
    heard = [(1.0, 5), (1.9, 21), (2.0, 7), (2.005, 9), (3.0, 11)]
    came = [*((1.1 + i / 5, 6) for i in range(4)), (2.2, 22), (2.4, 22), (3.1, 12)]
    seen = evidence(heard, came)
    seen.life.sent = [Sent(at, '/odds', {'data': n}) for at, n in heard if n != 21]
    seen.life.strangers = {'/odds': 1}
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(seen)
    assert refused.value.why.startswith('The answer is repeated')


def test_answer_that_is_always_the_same_is_no_answer_to_the_last_message() -> None:
    heard = [(1.0, 5), *((at + 0.0, 2 * at + 5) for at in range(2, 12)), (11.9, 5)]
    seen = evidence(heard, [(at, 6) for at, _ in heard])
    seen.life.sent = [Sent(at, '/odds', {'data': n}) for at, n in heard[:-1]]
    seen.life.strangers = {'/odds': 1}
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(seen)
    assert refused.value.seen == 'data = 6'


def test_answer_to_a_stranger_in_the_moment_of_a_test_is_not_for_the_test() -> None:
    heard = [(1.0, 5), (1.9, 21), (2.0, 7)]
    seen = evidence(heard, [(1.0, 6), (2.0, 22)])
    seen.life.sent = [Sent(1.0, '/odds', {'data': 5}), Sent(2.0, '/odds', {'data': 7})]
    seen.life.strangers = {'/odds': 1}
    with pytest.raises(Fail) as refused:
        CLAUSE.judge(seen)
    assert refused.value.seen == 'nothing on /evens'


def test_answer_that_is_left_out_now_and_then_is_still_one_of_a_timer() -> None:
    """Two messages came between two ticks of the timer, so that it has answered the second."""
    heard = [(1.0, 5), (2.0, 7), (2.1, 9), (3.0, 11)]
    came = [
        (at / 2, n) for n, ats in ((6, (2, 3, 4)), (10, (5, 6)), (12, range(7, 20))) for at in ats
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
    assert refused.value.why.startswith('1 of 2 messages were answered correctly')
    seen = evidence(heard, [(1.05, 6), (1.55, 8)])
    assert CLAUSE.judge(seen).startswith('/postman has answered 2 messages')


def lines(heard: list[tuple[float, str]], logged: list[tuple[float, str]]) -> Evidence:
    """Return evidence of half a minute with these texts and log lines."""
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
    clause = Logs('/chatter', 'std_msgs/msg/String', 'log it', draw=lambda: ['hello'])
    seen = lines([(2.0, 'hello')], [(0.05, 'from before'), (2.1, 'I heard hello')])
    assert clause.judge(seen) == (
        '/ear logged each of 1 texts in a line. Of lines from before the check, only those of '
        'timers were looked at.'
    )
    seen = lines([(2.0, 'hello')], [(1.05, 'from nowhere'), (2.1, 'I heard hello')])
    with pytest.raises(Fail, match='1 line more'):
        clause.judge(seen)


def test_empty_text_takes_the_line_that_is_like_the_others() -> None:
    clause = Logs('/chatter', 'std_msgs/msg/String', 'log it')
    logged = [(2.0, 'I heard: one'), (2.5, 'here'), (3.05, 'here'), (3.1, 'I heard: ')]
    with pytest.raises(Fail, match="'here', 'here'"):
        clause.judge(lines([(2.0, 'one'), (3.0, '')], logged))


def test_line_about_a_test_is_enough_where_a_stranger_says_the_same() -> None:
    clause = Logs('/chatter', 'std_msgs/msg/String', 'log it', draw=lambda: ['hello'])
    seen = lines([(2.0, 'hello'), (2.0, 'hello')], [(2.1, 'I heard hello')])
    with pytest.raises(Fail):
        clause.judge(seen)
    seen.life.sent = [Sent(2.0, '/chatter', {'data': 'hello'})]
    seen.life.strangers = {'/chatter': 1}
    assert clause.judge(seen)


def largest(best: int | None) -> Generator[int | None, int, None]:
    while True:
        value = yield best
        best = value if best is None else max(best, value)


def every_third(before: int) -> Generator[int | None, int, None]:
    answer = None
    while True:
        value = yield answer
        before += 1
        answer = value if before % 3 == 0 else None


def with_memory(answer: Any, **options: Any) -> Answers:
    return Answers('/odds', '/evens', INT16, 'as it remembers', answer, **options)


@pytest.mark.parametrize('before', [3, 7, 40])
def test_node_that_remembers_may_have_heard_something_before(before: int) -> None:
    heard = [(1.0, 5), (2.0, 9), (3.0, 2)]
    best = [max(before, 5), max(before, 9), max(before, 9)]
    came = [(at + 0.1, value) for (at, _), value in zip(heard, best, strict=True)]
    assert with_memory(largest).judge(evidence(heard, came))
    for number in range(3):
        wrong = [*came[:number], (came[number][0], 1), *came[number + 1 :]]
        with pytest.raises(Fail):
            with_memory(largest).judge(evidence(heard, wrong))


@pytest.mark.parametrize('first', [0, 1, 2])
def test_of_several_memories_one_has_to_fit(first: int) -> None:
    heard = [(float(n), n) for n in range(1, 10)]
    clause = with_memory(every_third, resume=lambda value, said: range(3))
    came = [(at + 0.1, n) for at, n in heard if n % 3 == first]
    assert clause.judge(evidence(heard, came))
    with pytest.raises(Fail):
        clause.judge(evidence(heard, came[1:]))
    with pytest.raises(Fail):
        clause.judge(evidence(heard, [*came, (4.2, 4), (5.2, 5)]))


def test_model_of_a_mistake_is_the_reason() -> None:
    doubled = Mistake('test/doubled', 'It is doubled.', 'Add 1.', model=lambda n: 2 * n)
    clause = Answers('/odds', '/evens', INT16, 'add 1', lambda n: n + 1, mistakes=[doubled])
    with pytest.raises(Fail) as refused:
        clause.judge(evidence([(1.0, 5)], [(1.1, 10)]))
    assert refused.value.mistake is doubled


def test_wrong_answer_that_is_right_for_another_message_does_not_hide_the_reason() -> None:
    """Each number is passed on as it came, and the answer to 12 would be 120."""
    passed = Mistake('test/passed', 'It is passed on.', 'Multiply.', model=int)
    clause = Answers('/odds', '/evens', INT16, 'times 10', lambda n: 10 * n, mistakes=[passed])
    numbers = [(1.0, 0), (1.2, 12), (1.4, 120), (1.6, 1498)]
    with pytest.raises(Fail) as refused:
        clause.judge(evidence(numbers, numbers))
    assert refused.value.mistake is passed


def total(begun: int | None, factor: int = 1) -> Generator[int | None, int, None]:
    said = begun or 0
    value = yield None
    while True:
        said += factor * value
        value = yield said


def test_model_with_a_memory_is_the_reason() -> None:
    twice = Mistake('test/twice', 'Counted twice.', model=partial(total, factor=2))
    clause = with_memory(total, mistakes=[twice], resume=lambda value, said: [0])
    with pytest.raises(Fail) as refused:
        clause.judge(evidence([(1.0, 5), (2.0, 4)], [(1.1, 10), (2.1, 18)]))
    assert refused.value.mistake is twice


@pytest.mark.parametrize('number', [1, 2])
def test_node_whose_first_answer_is_seen_has_heard_nothing_before(number: int) -> None:
    clause = with_memory(total, resume=lambda value, said: [said - value], answers_all=True)
    seen = evidence([(1.0, 5), (2.0, 4)], [(1.1, 6), (2.1, 10)])
    samples = seen.life.samples['/evens']
    samples[:] = [replace(sample, number=number + i) for i, sample in enumerate(samples)]
    if number > 1:
        assert clause.judge(seen)
    else:
        with pytest.raises(Fail):
            clause.judge(seen)


def test_number_may_be_off_as_far_as_the_task_allows() -> None:
    clause = Answers('/odds', '/evens', 'std_msgs/msg/Float64', '', lambda n: n / 3, near=1e-6)
    assert clause.judge(evidence([(1.0, 1)], [(1.1, cast(Any, 0.3333333))]))
    with pytest.raises(Fail):
        clause.judge(evidence([(1.0, 1)], [(1.1, cast(Any, 0.3333))]))


SMALL = Mistake('test/small', 'Not with a small h.', model=lambda t: 'Hi' if 'h' in t else None)
ONCE = Mistake('test/once', 'Another hello.', model=lambda t: 'Hi' if t == 'Hello' else None)
GREETS = Answers(
    '/lobby',
    '/lobby',
    'std_msgs/msg/String',
    'reply to Hello',
    answer=lambda text: 'Hi' if 'H' in text else None,
    mistakes=[SMALL, ONCE],
)


@pytest.mark.parametrize(
    ('replies', 'mistake'),
    [
        ([(1.1, 'Hi'), (2.1, 'Hi')], None),
        ([(1.1, 'Hi')], ONCE),
        ([(1.1, 'Hi'), (2.1, 'Hi'), (3.1, 'Hi')], SMALL),
        ([(1.1, 'Hi'), (1.1, 'oh'), (2.1, 'Hi')], answering.ITSELF),
        ([(1.1, 'Hi'), (1.2, 'Hi'), (2.1, 'Hi'), (2.2, 'Hi')], answering.TWICE),
    ],
)
def test_node_may_reply_where_it_listens(
    replies: list[tuple[float, str]], mistake: Mistake | None
) -> None:
    sent = [(1.0, 'Hello'), (2.0, 'Hello you'), (3.0, 'hello')]
    said = sorted([*sent, *replies])
    life = Life(30.0, {'/lobby': [Lived(SimpleNamespace(data=t), 0.0, 0, at) for at, t in said]})
    life.sent = [Sent(at, '/lobby', {'data': text}) for at, text in sent]
    ends = {('subscription', '/lobby', ''): SimpleNamespace(node='/ada')}
    seen = Evidence(cast(Any, None), ends=cast(Any, ends), life=life)
    if mistake is None:
        assert GREETS.judge(seen)
        return
    with pytest.raises(Fail) as refused:
        GREETS.judge(seen)
    assert refused.value.mistake is not None
    assert refused.value.mistake.id == mistake.id


def test_model_of_a_mistake_stands_in_a_line() -> None:
    upper = Mistake('test/upper', 'In capital letters.', model=str.upper)
    clause = Logs('/chatter', 'std_msgs/msg/String', 'log it', mistakes=[upper])
    for line, mistake in (('I heard HELLO', upper), ('I heard it', common_mistakes.LOGS_ELSE)):
        with pytest.raises(Fail) as refused:
            clause.judge(lines([(2.0, 'hello')], [(2.1, line)]))
        assert refused.value.mistake is mistake


def test_model_of_a_mistake_is_said_each_time() -> None:
    zero = Mistake('test/zero', 'It was never set.', model=lambda: 0)
    clause = Says('/ones', 1, mistakes=[zero])
    for values, mistake in (
        ([0, 0], zero),
        ([1, 0, 0], common_mistakes.LATER_WRONG),
        ([1, 2, 3], common_mistakes.CHANGES),
    ):
        seen = Evidence(cast(Any, None))
        samples = [Lived(SimpleNamespace(data=value), 0.0, 0, 0.0) for value in values]
        seen.streams['/ones', ''] = Stream('/ones', samples, True, 30.0)
        with pytest.raises(Fail) as refused:
            clause.judge(seen)
        assert refused.value.mistake is mistake
