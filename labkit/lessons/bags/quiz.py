"""The quiz on bags; two of its questions are about a bag that is drawn anew each time."""

from __future__ import annotations

from labkit.exercises import Quiz, guesses_of, words_of
from labkit.lessons.bags.made import TRIP_TOPICS, silent_topic, stop_sec, trip_is_missing

__all__ = ['GUESSES', 'QUIZ', 'WARM_UP']

WORDS = words_of(__file__)


def _explain_silent(word: str) -> str:
    missing = trip_is_missing()
    if missing:
        return missing
    if f'/{word.strip("/")}' in TRIP_TOPICS:
        return 'Its messages go on to the end of the strip. Which strip ends before the others?'
    return ''


WARM_UP = Quiz.of(WORDS, 'warm_up', cell_id='warm-up')

QUIZ = Quiz.of(
    WORDS,
    'bags',
    silent_topic={'answer': silent_topic, 'explain': _explain_silent},
    stop_sec={'answer': stop_sec, 'explain': trip_is_missing},
)

GUESSES = guesses_of(WORDS)
