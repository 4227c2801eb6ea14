"""Exercise: reply in one's own language, by a publisher that is made for it and used once."""

from __future__ import annotations

import random

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import WITHIN, Answers, Asked, Evidence, Words
from labkit.exercises.draws import draw_names, in_a_row
from labkit.exercises.observation import live

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
            f'one has published {max(numbers)} messages',
            KEPT,
        )
    probe, node = evidence.probe, evidence.subscription(TOPIC).node

    here = probe.node_object(node)

    def kept() -> int:
        if here is not None:
            return sum(each.topic_name == TOPIC for each in here.publishers)
        return sum(end.node == node for end in probe.publishers(TOPIC))

    if here is not None:
        live(probe, {TOPIC: STRING}, GONE_SEC, nodes=[node])
    else:
        # Until the graph tells that they are gone, or the check's time is over.
        probe.wait(lambda: not kept())
    if kept():
        raise Fail(
            f'no publisher of {node} on {TOPIC} between two replies',
            f'{kept()} of them',
            LEFT_BEHIND,
        )


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
