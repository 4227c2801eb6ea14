"""The exercises and quizzes of `16_your_own_machine.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons.your_own_machine import manifest, release
from labkit.lessons.your_own_machine.quiz import QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'your_own_machine',
    '16_your_own_machine.ipynb',
    title='Your own machine',
    minutes=60,
    teaches=(
        'Ubuntu, apt and distributions; rosdep; your package by git and as an archive; what '
        'Gazebo, RViz, Nav2, MoveIt and ros2_control are; two computers'
    ),
    exercises=[manifest, release],
    quizzes=[WARM_UP, QUIZ],
)
