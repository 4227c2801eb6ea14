"""The exercises and the quiz of `02_talker_listener.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.talker_listener import ears, every_two_seconds, hear_chatter, mouth, say_once
from labkit.lessons.talker_listener.quiz import QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'talker_listener',
    '02_talker_listener.ipynb',
    title='Talker and listener',
    minutes=70,
    teaches='publishers, subscribers, timers, the logger; why spin',
    exercises=[every_two_seconds, hear_chatter, ears, mouth, say_once],
    quizzes=[WARM_UP, QUIZ],
    topics=['/mail', '/stamped', '/news', *ROBOT_TOPICS],
    given={
        '/talker': 'talker-run listener-class',
        '/listener': 'listener-class',
        '/talker_1': 'two-talkers',
        '/talker_2': 'two-talkers',
        '/turtlebot': 'circle',
        '/circle': 'circle',
        '/writer': 'not-spun',
        '/reader': 'not-spun',
        '/stamped_talker': 'rate-loop',
        '/editor': 'too-early',
    },
)
