"""Exercise: a subscriber on /chatter."""

from __future__ import annotations

from labkit.exercises import Exercise, words_of
from labkit.exercises.clauses import WITHIN, Logs, Subscribes

__all__ = ['exercise']

WORDS = words_of(__file__)

STRING = 'std_msgs/msg/String'


exercise = Exercise(
    words=WORDS,
    clauses=(
        Subscribes('/chatter', STRING),
        Logs(
            '/chatter',
            STRING,
            WORDS.of(within=WITHIN).clause('logs'),
        ),
    ),
)
