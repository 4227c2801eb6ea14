"""Exercise: a node that subscribes and publishes."""

from __future__ import annotations

from labkit.exercises import Exercise, Mistake, Solution, anything
from labkit.exercises.clauses import WITHIN, Answers, Named

__all__ = ['exercise']

STRING = 'std_msgs/msg/String'


_UPPER = 'Publish msg.data.upper().'
MISTAKES = (
    Mistake(
        'mouth/passed-on',
        'The text is passed on as it came.',
        _UPPER,
        model=str,
        change=[('msg.data.upper()', 'msg.data')],
    ),
    Mistake(
        'mouth/lower',
        'lower() makes small letters.',
        _UPPER,
        model=str.lower,
        change=[('upper()', 'lower()')],
    ),
    Mistake(
        'mouth/first-letters',
        'Only first letters have become capital ones.',
        _UPPER,
        model=str.title,
        change=[('upper()', 'title()')],
    ),
    Mistake(
        'mouth/english-letters',
        'Not all letters have become capital ones.',
        _UPPER,
        model=lambda text: ''.join(c.upper() if c.isascii() else c for c in text),
    ),
    Mistake(
        'mouth/stripped',
        'The spaces at the ends are gone. A space is a character like any other.',
        _UPPER,
        model=lambda text: text.strip().upper(),
        change=[('upper()', 'strip().upper()')],
    ),
    Mistake(
        'mouth/of-its-own',
        'What is published is not the text of the message in capital letters.',
        'Use msg.data.',
        model=anything,
        change=[('msg.data.upper()', "'A CUP'")],
    ),
)

exercise = Exercise(
    name='mouth',
    task='A node mouth repeats each text of /thought on /speech, in capital letters.',
    clauses=(
        Named('/mouth'),
        Answers(
            '/thought',
            '/speech',
            STRING,
            'for each text on `/thought`, publish the same text in capital letters on `/speech` '
            f'(both `std_msgs/msg/String`), once, {WITHIN}',
            answer=str.upper,
            by='/mouth',
            mistakes=MISTAKES,
        ),
    ),
    hints=[
        'A node may have both: the publisher of Talker, and the subscription of Listener.',
        'The text that came in is msg.data; msg.data.upper() is the same in capitals.',
        'Publish in the callback: there the message is at hand.',
    ],
    answer=Solution(
        __file__,
        'mouth.py',
        'The callback runs once for each message, so each message gets one answer. The publisher '
        'is made once, in __init__, and used again and again.',
    ),
)
