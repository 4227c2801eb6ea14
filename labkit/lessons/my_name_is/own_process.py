"""Exercise: the first stage as a program in a file, run in a terminal."""

from __future__ import annotations

from labkit.exercises import Exercise, words_of
from labkit.exercises.clauses import Publishes
from labkit.lessons._terminal import RunsFile
from labkit.lessons.my_name_is.stages import INNER, STRING, says_opening

__all__ = ['exercise']

WORDS = words_of(__file__)

exercise = Exercise(
    words=WORDS,
    clauses=(
        RunsFile('nodes/stage_one.py', ['/stage_one']),
        Publishes(INNER, 2.0, STRING),
        says_opening(),
    ),
)
