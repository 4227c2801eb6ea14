"""Exercise: find what does not match, and mend the one end that is yours."""

from __future__ import annotations

from labkit.exercises import Exercise, words_of
from labkit.exercises.clauses import Matches, Publishes, Says
from labkit.lessons.quality_of_service.lock import NODE, TOPIC, is_untouched

__all__ = ['exercise']

WORDS = words_of(__file__)

INT16 = 'std_msgs/msg/Int16'


exercise = Exercise(
    words=WORDS,
    clauses=(
        Publishes(TOPIC, 5.0, INT16),
        Says(TOPIC, 1, words=WORDS.of(number=1).clause('says')),
        Matches(
            TOPIC,
            NODE,
            WORDS.clause('matches'),
            start='Run the cell with start_lock().',
            subscribes=True,
            is_as_given=is_untouched,
        ),
    ),
)
