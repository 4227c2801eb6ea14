"""The warm-up exercise and the quiz of `00_start_here.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.start_here import first_node
from labkit.lessons.start_here.quiz import QUIZ

__all__ = ['LESSON']

LESSON = Lesson(
    'start_here',
    '00_start_here.ipynb',
    title='Start here',
    minutes=20,
    teaches='a robot to drive; your first message; how a lesson works',
    exercises=[first_node],
    quizzes=[QUIZ],
    topics=['/greetings', *ROBOT_TOPICS],
    given={
        '/first_node': 'first-node',
        '/listener': 'first-node',
        '/turtlebot': 'robot',
        '/teleop': 'robot',
    },
)
