"""The exercises and the quiz of `07_turtlebot.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.turtlebot import bot, go_to, square, stop, wall
from labkit.lessons.turtlebot.quiz import GUESSES, QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'turtlebot',
    '07_turtlebot.ipynb',
    title='The turtlebot',
    minutes=120,
    teaches='a robot on real topics: drive it, read its odometry, write its controller',
    exercises=[wall, bot, go_to, square, stop],
    quizzes=[WARM_UP, QUIZ],
    guesses=GUESSES,
    topics=[
        *ROBOT_TOPICS,
    ],
    given={'/turtlebot': '*', '/teleop': '*', '/bot': 'bot-run', '/speedometer': 'speedometer'},
)
