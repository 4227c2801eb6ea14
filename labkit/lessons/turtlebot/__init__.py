"""The exercises and the quiz of `07_turtlebot.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.turtlebot.bot import bot
from labkit.lessons.turtlebot.go_to import go_to
from labkit.lessons.turtlebot.quiz import QUIZ, WARM_UP
from labkit.lessons.turtlebot.square import square
from labkit.lessons.turtlebot.stop import stop
from labkit.lessons.turtlebot.wall import wall

__all__ = ['LESSON']

LESSON = Lesson(
    'turtlebot',
    '07_turtlebot.ipynb',
    title='The turtlebot',
    minutes=120,
    teaches='a robot on real topics: drive it, read its odometry, write its controller',
    exercises=[wall, bot, go_to, square, stop],
    quizzes=[WARM_UP, QUIZ],
    topics=[
        *ROBOT_TOPICS,
    ],
    given={'/turtlebot': '*', '/teleop': '*', '/bot': 'bot-run', '/speedometer': 'speedometer'},
)
