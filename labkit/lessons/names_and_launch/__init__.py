"""The exercises and quizzes of `13_names_and_launch.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons.names_and_launch import arguments, ending, faults, hearing, system
from labkit.lessons.names_and_launch.quiz import GUESSES, QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'names_and_launch',
    '13_names_and_launch.ipynb',
    title='Names and launch files',
    minutes=100,
    teaches=(
        'namespaces, remapping, parameter files; many nodes started by one file, in XML, YAML and '
        'Python; what ends with what'
    ),
    exercises=[system, hearing, faults, arguments, ending],
    quizzes=[WARM_UP, QUIZ],
    guesses=GUESSES,
)
