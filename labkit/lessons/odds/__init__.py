"""The exercises and the quiz of `04_odds.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.odds import count_up, evens, find_gate, ones, stay_within
from labkit.lessons.odds.quiz import GUESSES, QUIZ, WARM_UP
from labkit.lessons.odds.stadium import GOALS, NODES, VISITORS

__all__ = ['LESSON']

LESSON = Lesson(
    'odds',
    '04_odds.ipynb',
    title='Odd numbers',
    minutes=70,
    teaches='numbers on topics, types and their limits, queues; finding a silent fault',
    exercises=[ones, count_up, stay_within, evens, find_gate],
    quizzes=[WARM_UP, QUIZ],
    guesses=GUESSES,
    topics=['/high', '/burst', '/speed', GOALS, VISITORS, *ROBOT_TOPICS],
    given={
        '/counter': 'counter',
        '/one': 'add-one',
        '/add_one': 'add-one',
        '/turtlebot': 'speed',
        '/driver': 'speed',
        '/reader': 'burst',
        '/sprinter': 'burst',
        '/announcer': 'stadium repair',
        **dict.fromkeys(NODES, ''),
    },
)
