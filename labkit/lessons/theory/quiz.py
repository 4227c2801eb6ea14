"""The quiz of lesson 01; some answers are read off the graph."""

from __future__ import annotations

from labkit.exercises import Quiz, words_of

__all__ = ['QUIZ']

WORDS = words_of(__file__)


def publishers_of_sight() -> int:
    """Count the publishers of /sight at this moment."""
    from labkit.asking.discovery import asking_node

    return asking_node().count_publishers('/sight')


def _no_eye(number: float) -> str:
    """Say which cell makes an Eye, if none runs."""
    if publishers_of_sight():
        return ''
    return 'At this moment it has none. Run the cell with the class Eye, and count again.'


QUIZ = Quiz.of(
    WORDS, 'theory', publishers_of_sight={'answer': publishers_of_sight, 'explain': _no_eye}
)
