"""Exercise: show everybody's messages, with who has said them."""

from __future__ import annotations

import random

from labkit.exercises import Exercise, Mistake, anything, words_of
from labkit.exercises.clauses import WITHIN, Logs, Subscribes, Words
from labkit.exercises.draws import KNOWN, draw_names, draw_texts, in_a_row

__all__ = ['exercise']

WORDS = words_of(__file__)

TOPIC, STRING = '/hall', 'std_msgs/msg/String'
NAMELESS = Words(WORDS.clause('nameless'))
ALONE = Words(WORDS.of(within=WITHIN).clause('alone'))


def _named(message: str | None) -> str:
    return ALONE.text if message is None else '' if ': ' in message else NAMELESS.text


def _line(message: str) -> str:
    who, colon, text = message.partition(': ')
    return f'{who} says {text}' if colon else f'somebody says {message}'


def _draw() -> list[str]:
    """Return messages with a name, among them some with two colons, and some without a name."""
    names, texts = draw_names(), draw_texts(empty=False)
    number = random.randint
    # Who speaks may have a name that the lesson knows.
    names += KNOWN
    said = [f'{names[i % len(names)]}: {text}' for i, text in enumerate(dict.fromkeys(texts))]
    more = [
        f'no name {number(1, 99)}',
        f'no name  {number(1, 99)}, and  blanks',
        f'{number(1, 9)}:{number(10, 59)}',
        f'{names[0]}:without a blank',
        '',
    ]
    return in_a_row(said[:2], [*said[2:], *more])


CUT_NAME = WORDS.mistake('hearer/cut-name')
CHANGED_NAME = WORDS.mistake('hearer/changed-name')


def _name_trouble(message: str, line: str) -> Mistake | None:
    """Return what is wrong with the name in a line, if the rest of it is right."""
    who, colon, text = message.partition(': ')
    said, says, rest = line.partition(' says ')
    if not colon or not says or rest != text or said == who or not said:
        return None
    if said in who:
        return CUT_NAME.of(who=who, said=said)
    return CHANGED_NAME.of(who=who, said=said) if said.lower() == who.lower() else None


MISTAKES = (
    WORDS.mistake(
        'hearer/nobody', lambda message: None if ': ' in message else message.partition(':')[0]
    ),
    WORDS.mistake('hearer/as-it-came', lambda message: message),
    WORDS.mistake(
        'hearer/last-colon', lambda message: '{0} says {2}'.format(*message.rpartition(': '))
    ),
    WORDS.mistake('hearer/each-colon', lambda message: '{} says {}'.format(*message.split(': '))),
    WORDS.mistake('hearer/no-name', lambda message: message.partition(': ')[2] or None),
    WORDS.mistake('hearer/another-text', anything),
)

exercise = Exercise(
    words=WORDS,
    clauses=(
        Subscribes(TOPIC, STRING),
        Logs(
            TOPIC,
            STRING,
            WORDS.clause('logs'),
            _draw,
            line=_line,
            mistakes=MISTAKES,
            explain=_name_trouble,
            named=_named,
        ),
        NAMELESS,
        ALONE,
    ),
)
