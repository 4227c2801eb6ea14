"""The exercises and the quiz of `11_package.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons.package import beacon, counter, listener, repair
from labkit.lessons.package.quiz import GUESSES, QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'package',
    '11_package.ipynb',
    title='From notebook to package',
    minutes=85,
    teaches=(
        'make a package with an editor and two terminals, build it with colcon, run, break and '
        'repair it; turn the class of a notebook into a package'
    ),
    exercises=[listener, repair, counter, beacon],
    quizzes=[WARM_UP, QUIZ],
    guesses=GUESSES,
    topics=['/chatter', '/count', '/half', '/lit', '/news'],
)
