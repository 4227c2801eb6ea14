"""Exercise: start a node of a given name."""

from __future__ import annotations

from labkit.exercises import Exercise, words_of
from labkit.exercises.clauses import Named, Runs

__all__ = ['exercise']

WORDS = words_of(__file__)

exercise = Exercise(
    words=WORDS,
    clauses=(
        Named('/hello_robot'),
        Runs(WORDS.clause('runs'), node='/hello_robot'),
    ),
)
