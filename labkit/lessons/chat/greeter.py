"""Exercise: reply in one's own language, by a publisher that is made for it and used once."""

from __future__ import annotations

import random

from labkit.exercises import Exercise, Fail, Mistake, Solution
from labkit.exercises.clauses import WITHIN, Answers, Asked, Evidence, Words
from labkit.exercises.draws import draw_names, in_a_row
from labkit.exercises.observation import live

__all__ = ['exercise']

TOPIC, STRING = '/lobby', 'std_msgs/msg/String'
ME = 'Ada'
REPLY = f'{ME}: Salut'
NOTHING = Words('publish nothing for any other message')
# How long a node may keep a publisher after its reply, s of its time.
GONE_SEC = 2.0

_IN = "'Hello' in msg.data tells whether the word is in the text."
MISTAKES = (
    Mistake(
        'greeter/small-letters',
        'Capital and small letters differ, and the task asks for Hello.',
        _IN,
        model=lambda text: REPLY if 'hello' in text.lower() else None,
        change=[("'Hello' in msg.data", "'hello' in msg.data.lower()")],
    ),
    Mistake(
        'greeter/everything',
        'This message does not say Hello.',
        _IN,
        model=lambda text: REPLY,
        change=[("if 'Hello' in msg.data:", "if msg.data != 'Ada: Salut':")],
    ),
    Mistake(
        'greeter/nothing-beside',
        'This message says Hello, too, and something else beside it.',
        _IN,
        model=lambda text: REPLY if text in ('Hello', 'Bo: Hello') else None,
        change=[("'Hello' in msg.data", "msg.data in ('Hello', 'Bo: Hello')")],
    ),
    Mistake(
        'greeter/lost',
        'Nothing came. Is a publisher made, used, and destroyed only then?',
        'Make it in the callback, publish, wait_for_all_acked(), and destroy it then.',
        model=lambda text: None,
    ),
)
KEPT = Mistake(
    'greeter/kept',
    'A publisher that is kept is used again and again.',
    'Call create_publisher() when a reply is due, and destroy_publisher() afterwards.',
)
LEFT_BEHIND = Mistake(
    'greeter/left-behind',
    'Each reply leaves a publisher behind, and they become more and more.',
    'self.destroy_publisher(publisher), when the reply is on its way.',
    change=[('            self.destroy_publisher(publisher)\n', '')],
)


def _draw() -> list[str]:
    """Return texts with and without the word, in the middle and in other letters."""
    names = iter(draw_names(12))
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
    name='greeter',
    task='Reply to Hello on /lobby, each time with a publisher that is made for it.',
    shared=[TOPIC],
    clauses=(
        Answers(
            TOPIC,
            TOPIC,
            STRING,
            f'for each message on `{TOPIC}` (`{STRING}`) with the word `Hello` in it, publish '
            f'`{REPLY}` there, once, {WITHIN}',
            answer=lambda text: REPLY if 'Hello' in text else None,
            draw=_draw,
            mistakes=MISTAKES,
            otherwise=NOTHING.text,
        ),
        NOTHING,
        Asked(
            'each reply comes from a publisher of its own, which is destroyed afterwards',
            _used_once,
        ),
    ),
    hints=[
        'create_publisher() may be called in a callback, too, and not only in __init__.',
        'What was published may be on its way when the publisher goes. wait_for_all_acked() waits '
        'until it has arrived.',
        'In the callback: make the publisher, publish, publisher.wait_for_all_acked(Duration('
        'seconds=1)), self.destroy_publisher(publisher)',
    ],
    answer=Solution(
        __file__,
        'greeter.py',
        'The publisher lives in a variable of the callback, for one message. In between, the node '
        'only listens.',
    ),
)
