"""Exercise: keep the newest message for subscriptions that come later."""

from __future__ import annotations

from labkit.exercises import Exercise, anything, words_of
from labkit.exercises.clauses import WITHIN, Answers, Latched

__all__ = ['exercise']

WORDS = words_of(__file__)

STRING = 'std_msgs/msg/String'

MORE = WORDS.mistake('site/more', anything)

exercise = Exercise(
    words=WORDS,
    clauses=(
        Answers(
            '/move',
            '/site',
            STRING,
            WORDS.of(within=WITHIN).clause('answers'),
            answer=str,
            mistakes=[MORE],
        ),
        Latched(
            '/site',
            WORDS.clause('latched'),
        ),
    ),
)
