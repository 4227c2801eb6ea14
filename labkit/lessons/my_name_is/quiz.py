"""The quiz on chains of nodes."""

from __future__ import annotations

from labkit.exercises import Quiz, guesses_of, words_of

__all__ = ['GUESSES', 'QUIZ', 'WARM_UP']

WORDS = words_of(__file__)


def _listeners_of_incomplete() -> int:
    """Count the subscriptions to /incomplete at this moment."""
    from labkit.asking.discovery import asking_node

    return asking_node().count_subscribers('/incomplete')


def _nobody_listens(number: float) -> str:
    """Say which cell makes a listener, if there is none."""
    if _listeners_of_incomplete():
        return ''
    return 'At this moment it has none. Run the cell with your StageTwo, and ask the graph again.'


WARM_UP = Quiz.of(WORDS, 'warm_up', cell_id='warm-up')

QUIZ = Quiz.of(
    WORDS,
    'my_name_is',
    listeners_of_incomplete={'answer': _listeners_of_incomplete, 'explain': _nobody_listens},
)

GUESSES = guesses_of(WORDS)
