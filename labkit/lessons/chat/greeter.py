"""Exercise: reply in one's own language, by a publisher that is made for it and used once."""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import WITHIN, Answers, Asked, Evidence, Words
from labkit.exercises.draws import draw_names, in_a_row
from labkit.exercises.figures import many
from labkit.exercises.observation import Stimulus, live

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.publisher import Publisher

__all__ = ['exercise']

WORDS = words_of(__file__)

TOPIC, STRING = '/lobby', 'std_msgs/msg/String'
ME = 'Ada'
REPLY = f'{ME}: Salut'
NOTHING = Words(WORDS.clause('nothing'))
# How long a node may keep a publisher after its reply, s of its time.
GONE_SEC = 2.0

MISTAKES = (
    WORDS.mistake(
        'greeter/small-letters', lambda text: REPLY if 'hello' in text.lower() else None
    ),
    WORDS.mistake('greeter/everything', lambda text: REPLY),
    WORDS.mistake(
        'greeter/nothing-beside', lambda text: REPLY if text in ('Hello', 'Bo: Hello') else None
    ),
    WORDS.mistake('greeter/lost', lambda text: None),
)
KEPT = WORDS.mistake('greeter/kept')
LEFT_BEHIND = WORDS.mistake('greeter/left-behind')


AT_ONCE = WORDS.mistake('greeter/at-once')


def _draw() -> list[str]:
    """Return texts with and without the word, in the middle and in other letters."""
    names = iter(draw_names(26))
    number = random.randint(10, 99)
    texts = [
        f'{next(names)}: now that I am here I say Hello to number {number}',
        f'{next(names)}: Hello Hello {number}',
        f'{next(names)}: Hello Ada',
        f'{next(names)}:  {number}  Hello  ',
        'Hello',
        f'{next(names)}: hello {number}',
        f'{next(names)}: HELLO {number}',
        f'{next(names)}: Hell o {number}',
        f'{next(names)}: H e l l o',
        f'{next(names)}: Salut {number}',
        f'{ME}: Hi {number}',
        f'{next(names)}: Hello World: {number}',
        f'{ME}: Hello',
        f'{ME}: Hello {number}',
        f'{REPLY} {number}',
        f'Hello {next(names)}: Good morning',
        '',
        ' ',
        *(f'{name}: Hello' for name in names),
    ]
    return in_a_row(['Bo: Hello', f'Bo: Good morning {number}'], texts)


def _used_once(evidence: Evidence) -> None:
    """Look at the numbers of the messages, which each publisher counts from 1, and for it."""
    numbers = [sample.number for sample in evidence.life.besides_tests(TOPIC)]
    if max(numbers) > 1:
        raise Fail(
            'a publisher of its own for each reply',
            f'one has published {many(max(numbers), "message")}',
            KEPT,
        )
    probe, node = evidence.probe, evidence.subscription(TOPIC).node

    here = probe.node_object(node)

    def kept() -> int:
        if here is not None:
            return sum(each.topic_name == TOPIC for each in here.publishers)
        return sum(end.node == node for end in probe.publishers(TOPIC))

    if here is not None:
        # In this process all arrives at once, so it is looked at how the publisher is treated.
        hello = Stimulus(at=0.5, topic=TOPIC, msg_type=STRING, fields={'data': 'Bo: Hello'})
        with _destroyed_at_once(here) as hasty:
            live(probe, {TOPIC: STRING}, GONE_SEC, stimuli=[hello], nodes=[node])
        if hasty:
            raise Fail(
                'a publisher that is destroyed when its message has arrived',
                f'one of {node} that has not waited for that',
                AT_ONCE,
            )
    else:
        # Until the graph tells that they are gone, or the check's time is over.
        probe.wait(lambda: not kept())
    if kept():
        raise Fail(
            f'no publisher of {node} on {TOPIC} between two replies',
            f'{kept()} of them',
            LEFT_BEHIND,
        )


@contextmanager
def _destroyed_at_once(node: Node) -> Iterator[list[Publisher]]:
    """Note the publishers that are destroyed in the moment of their last message, unasked."""
    from rclpy.publisher import Publisher

    from labkit.asking.traffic import Publication, publications

    made: Any = Publisher
    acked, destroyed = made.wait_for_all_acked, made.destroy
    said = WeakKeyDictionary[Publisher, int]()
    found: list[Publisher] = []

    def now() -> int:
        return int(node.get_clock().now().nanoseconds)

    def note(publication: Publication) -> None:
        said[publication.publisher] = now()

    def wait(self: Publisher, *args: Any, **kwargs: Any) -> Any:
        said.pop(self, None)
        return acked(self, *args, **kwargs)

    def destroy(self: Publisher) -> None:
        if said.pop(self, None) == now():
            found.append(self)
        destroyed(self)

    made.wait_for_all_acked, made.destroy = wait, destroy
    try:
        with publications(note):
            yield found
    finally:
        made.wait_for_all_acked, made.destroy = acked, destroyed


exercise = Exercise(
    words=WORDS,
    shared=[TOPIC],
    clauses=(
        Answers(
            TOPIC,
            TOPIC,
            STRING,
            WORDS.of(within=WITHIN).clause('answers'),
            answer=lambda text: REPLY if 'Hello' in text else None,
            draw=_draw,
            mistakes=MISTAKES,
            otherwise=NOTHING.text,
        ),
        NOTHING,
        Asked(
            WORDS.clause('used-once'),
            _used_once,
        ),
    ),
)
