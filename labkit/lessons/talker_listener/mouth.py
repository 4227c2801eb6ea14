"""Exercise: a node that subscribes and publishes."""

from __future__ import annotations

from labkit.exercises import Exercise, anything, words_of
from labkit.exercises.clauses import WITHIN, Answers, Named

__all__ = ['exercise']

WORDS = words_of(__file__)

STRING = 'std_msgs/msg/String'

MISTAKES = (
    WORDS.mistake('mouth/passed-on', str),
    WORDS.mistake('mouth/lower', str.lower),
    WORDS.mistake('mouth/first-letters', str.title),
    WORDS.mistake(
        'mouth/english-letters',
        lambda text: ''.join(c.upper() if c.isascii() else c for c in text),
    ),
    WORDS.mistake('mouth/stripped', lambda text: text.strip().upper()),
    WORDS.mistake('mouth/of-its-own', anything),
)

exercise = Exercise(
    words=WORDS,
    clauses=(
        Named('/mouth'),
        Answers(
            '/thought',
            '/speech',
            STRING,
            WORDS.of(within=WITHIN).clause('answers'),
            answer=str.upper,
            by='/mouth',
            mistakes=MISTAKES,
        ),
    ),
)
