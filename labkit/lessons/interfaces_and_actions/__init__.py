"""The exercises and the quiz of `12_interfaces_and_actions.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.interfaces_and_actions import asker, countdown, leg, stairs
from labkit.lessons.interfaces_and_actions.quiz import GUESSES, QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'interfaces_and_actions',
    '12_interfaces_and_actions.ipynb',
    title='Interfaces and actions',
    minutes=100,
    teaches=(
        'work that takes long: goal, feedback, result, cancel; types of your own, built '
        'by colcon (this part needs a C++ compiler)'
    ),
    exercises=[stairs, countdown, asker, leg],
    quizzes=[WARM_UP, QUIZ],
    guesses=GUESSES,
    topics=[
        *ROBOT_TOPICS,
    ],
    given={
        '/turtlebot': '*',
        '/fibonacci': 'server choosy',
        '/watcher': 'client',
        '/driver': 'drive',
        '/rider': 'drive',
        '/calculator': 'calculator',
    },
)
