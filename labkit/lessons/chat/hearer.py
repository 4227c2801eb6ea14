"""Exercise: show everybody's messages, with who has said them."""

from __future__ import annotations

import random

from labkit.exercises import Exercise, Mistake, Solution, anything
from labkit.exercises.clauses import WITHIN, Logs, Subscribes, Words
from labkit.exercises.draws import draw_names, draw_texts, in_a_row

__all__ = ['exercise']

TOPIC, STRING = '/hall', 'std_msgs/msg/String'
NAMELESS = Words('for a message without a name, such as `Hello`, log `somebody says Hello`')
ALONE = Words(f'log one line for each message, {WITHIN}, and no other line')


def _named(message: str | None) -> str:
    return ALONE.text if message is None else '' if ': ' in message else NAMELESS.text


def _line(message: str) -> str:
    who, colon, text = message.partition(': ')
    return f'{who} says {text}' if colon else f'somebody says {message}'


def _draw() -> list[str]:
    """Return messages with a name, among them some with two colons, and some without a name."""
    names, texts = draw_names(), draw_texts(empty=False)
    number = random.randint
    said = [f'{names[i % len(names)]}: {text}' for i, text in enumerate(dict.fromkeys(texts))]
    more = [
        f'no name {number(1, 99)}',
        f'no name  {number(1, 99)}, and  blanks',
        f'{number(1, 9)}:{number(10, 59)}',
        f'{names[0]}:without a blank',
        '',
    ]
    return in_a_row(said[:2], [*said[2:], *more])


_PARTS = "who, colon, text = msg.data.partition(': ') divides at the first one."
MISTAKES = (
    Mistake(
        'hearer/nobody',
        'In this message nobody says who he is: it has no colon with a space after it.',
        "Look whether colon is empty after who, colon, text = msg.data.partition(': ')",
        model=lambda message: None if ': ' in message else message.partition(':')[0],
    ),
    Mistake(
        'hearer/as-it-came',
        'That is the message as it came.',
        "Take it apart: who, colon, text = msg.data.partition(': ')",
        model=lambda message: message,
    ),
    Mistake(
        'hearer/last-colon',
        'A text may hold a colon, too. The name stands before the first one.',
        _PARTS,
        model=lambda message: '{0} says {2}'.format(*message.rpartition(': ')),
        change=[('.partition(', '.rpartition(')],
    ),
    Mistake(
        'hearer/each-colon',
        'The text ends at its own colon.',
        _PARTS,
        model=lambda message: '{} says {}'.format(*message.split(': ')),
    ),
    Mistake(
        'hearer/no-name',
        'The name is missing, or the word says.',
        'Put the name and the word says before the text.',
        model=lambda message: message.partition(': ')[2] or None,
        change=[('{who} says {text}', '{len(who)} letters say {text}')],
    ),
    Mistake(
        'hearer/another-text',
        'The text in the line is not the one that came.',
        'Put the whole text behind the word says.',
        model=anything,
        change=[('{who} says {text}', '{who} says {len(text)} letters')],
    ),
)

exercise = Exercise(
    name='hearer',
    task='Log each message of /hall with who has said it.',
    clauses=(
        Subscribes(TOPIC, STRING),
        Logs(
            TOPIC,
            STRING,
            'for `Bo: Hello`, log a line with `Bo says Hello`: a name ends at the first colon '
            'that a space follows',
            _draw,
            line=_line,
            mistakes=MISTAKES,
            named=_named,
        ),
        NAMELESS,
        ALONE,
    ),
    hints=[
        'A text has a method that divides it at the first place where something stands.',
        "'Bo: Hello'.partition(': ') gives three parts: 'Bo', ': ' and 'Hello'. What are they for "
        "'Hello'?",
        "who, colon, text = msg.data.partition(': '), and if not colon: who, text = 'somebody', "
        'msg.data',
    ],
    answer=Solution(
        __file__,
        'hearer.py',
        'partition() divides at the first colon with a space. If there is none, the second of its '
        'three parts is empty.',
    ),
)
