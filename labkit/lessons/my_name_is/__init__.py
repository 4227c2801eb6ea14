"""The exercises and the quiz of `05_my_name_is.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.my_name_is import own_process, third_stage, two_stages, welcome
from labkit.lessons.my_name_is.quiz import GUESSES, QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'my_name_is',
    '05_my_name_is.ipynb',
    title='My name is',
    minutes=60,
    teaches='a chain of nodes, in one process and in several',
    exercises=[two_stages, own_process, third_stage, welcome],
    quizzes=[WARM_UP, QUIZ],
    guesses=GUESSES,
    topics=['/celsius', '/fahrenheit', '/word', *ROBOT_TOPICS],
    given={'/observer': 'remove-stage-one', '/turtlebot': 'word', '/translator': 'word'},
)
