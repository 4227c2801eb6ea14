"""The exercises and the quiz of `05_my_name_is.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.my_name_is.own_process import own_process
from labkit.lessons.my_name_is.quiz import QUIZ, WARM_UP
from labkit.lessons.my_name_is.third_stage import third_stage
from labkit.lessons.my_name_is.two_stages import two_stages
from labkit.lessons.my_name_is.welcome import welcome

__all__ = ['LESSON']

LESSON = Lesson(
    'my_name_is',
    '05_my_name_is.ipynb',
    title='My name is',
    minutes=60,
    teaches='a chain of nodes, in one process and in several',
    exercises=[two_stages, own_process, third_stage, welcome],
    quizzes=[WARM_UP, QUIZ],
    topics=['/celsius', '/fahrenheit', '/word', *ROBOT_TOPICS],
    given={'/observer': 'remove-stage-one', '/turtlebot': 'word', '/translator': 'word'},
)
