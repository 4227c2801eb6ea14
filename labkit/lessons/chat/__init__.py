"""The exercises and the quiz of `06_chat.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.chat import greeter, hearer, polite, typed_text
from labkit.lessons.chat.quiz import GUESSES, QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'chat',
    '06_chat.ipynb',
    title='Chat',
    minutes=75,
    teaches=(
        "typed text, everybody's messages; share one topic with other computers; replies "
        'without an end'
    ),
    exercises=[typed_text, hearer, greeter, polite],
    quizzes=[WARM_UP, QUIZ],
    guesses=GUESSES,
    topics=['/shared_chatter', '/heard_next_door', *ROBOT_TOPICS],
    given={
        '/turtlebot': 'rosie-go',
        '/rosie': 'rosie-go',
        '/chat': 'chat',
        '/domain_bridge': 'join',
        '/neighbour': '',
        '/one_shot': 'one-shot',
        '/bo': 'repliers remedies',
        '/chidi': 'repliers remedies',
    },
)
