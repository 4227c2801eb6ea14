"""The quiz of lesson 01."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.theory.quiz import QUIZ

__all__ = ['LESSON']

LESSON = Lesson(
    'theory',
    '01_theory.ipynb',
    title='What ROS is',
    minutes=35,
    teaches='the words and pictures of ROS; ROS 1 and ROS 2',
    quizzes=[QUIZ],
    topics=['/sight', '/move', *ROBOT_TOPICS],
    given={
        '/turtlebot': 'robot-graph',
        '/left_eye': 'eye-class',
        '/right_eye': 'legs-class',
        '/brain': 'brain-class',
        '/left_leg': 'legs-class',
        '/right_leg': 'legs-class',
    },
)
