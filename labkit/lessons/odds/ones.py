"""Exercise: the number 1, without end."""

from __future__ import annotations

from labkit.exercises import Exercise, anything, words_of
from labkit.exercises.clauses import Publishes, Says

__all__ = ['exercise']

WORDS = words_of(__file__)

INT16 = 'std_msgs/msg/Int16'

MISTAKES = (
    WORDS.mistake('ones/never-set', lambda: 0),
    WORDS.mistake('ones/another-number', anything),
)

exercise = Exercise(
    words=WORDS,
    clauses=(
        Publishes('/ones', 10.0, INT16),
        Says('/ones', 1, words=WORDS.of(number=1).clause('says'), mistakes=MISTAKES),
    ),
)
