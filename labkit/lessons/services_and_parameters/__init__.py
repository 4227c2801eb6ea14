"""The exercises and the quiz of `09_services_and_parameters.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.services_and_parameters import lamp, metronome, pilot, porter
from labkit.lessons.services_and_parameters.quiz import GUESSES, QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'services_and_parameters',
    '09_services_and_parameters.ipynb',
    title='Services and parameters',
    minutes=80,
    teaches=(
        'ask and answer, a callback that waits for itself; settings of a running node, '
        'and refusing bad ones'
    ),
    exercises=[lamp, porter, metronome, pilot],
    quizzes=[WARM_UP, QUIZ],
    guesses=GUESSES,
    topics=[
        *ROBOT_TOPICS,
        '/knock',
    ],
    given={
        '/turtlebot': '*',
        '/gate': 'gate',
        '/visitor': 'call',
        '/bell': 'deadlock repair',
        '/door': 'deadlock',
        '/cruiser': 'cruiser start-file',
    },
)
