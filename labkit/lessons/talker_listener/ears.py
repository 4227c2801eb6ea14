"""Exercise: one program in a file, run in two terminals: its nodes publish on one topic."""

from __future__ import annotations

from labkit.exercises import Exercise, words_of
from labkit.exercises.clauses import HasText, NobodyElse, Publishes
from labkit.lessons._terminal import RunsFile

__all__ = ['exercise']

WORDS = words_of(__file__)

STRING = 'std_msgs/msg/String'
EARS = ('/left_ear', '/right_ear')


exercise = Exercise(
    words=WORDS,
    shared=['/sound'],
    clauses=(
        RunsFile('nodes/ear.py', EARS),
        *(Publishes('/sound', 5.0, STRING, by=ear) for ear in EARS),
        HasText('/sound', by=EARS),
        NobodyElse('/sound', EARS),
    ),
)
