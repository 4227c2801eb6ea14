"""The exercises and the quiz of `10_bags.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.bags import distance, half_speed, one_topic
from labkit.lessons.bags.quiz import GUESSES, QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'bags',
    '10_bags.ipynb',
    title='Bags',
    minutes=75,
    teaches=(
        'record a drive, look inside, plot it, play it back; a node cannot tell a bag from a robot'
    ),
    exercises=[one_topic, distance, half_speed],
    quizzes=[WARM_UP, QUIZ],
    guesses=GUESSES,
    topics=[
        *ROBOT_TOPICS,
        '/clock',
        '/temperature',
        '/wind',
        '/rain',
    ],
    given={
        '/turtlebot': '*',
        '/pilot': 'pilot',
        '/odometer': 'odometer',
        '/twin': 'twin',
        '/clerk': 'clock',
        '/weather': 'weather',
    },
)
