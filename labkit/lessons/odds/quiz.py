"""The quiz on types, limits and queues."""

from __future__ import annotations

from labkit.exercises import Quiz, guesses_of, words_of
from labkit.lessons.odds.stadium import VISITORS

__all__ = ['GUESSES', 'QUIZ', 'WARM_UP']

WORDS = words_of(__file__)


def _publishers_of_visitors() -> int:
    """Count the publishers of the stadium's topic at this moment."""
    from labkit.asking.discovery import asking_node

    return asking_node().count_publishers(VISITORS)


def _stadium_is_closed(number: float) -> str:
    """Say which cell opens the stadium, if nobody publishes there."""
    if _publishers_of_visitors():
        return ''
    return 'At this moment there is none. Run the cell with open_stadium(), and count again.'


WARM_UP = Quiz.of(WORDS, 'warm_up', cell_id='warm-up')

QUIZ = Quiz.of(
    WORDS,
    'odds',
    publishers_of_visitors={'answer': _publishers_of_visitors, 'explain': _stadium_is_closed},
)

GUESSES = guesses_of(WORDS)
