"""A small lesson with the engine's whole range, to prove the harness and the engine with."""

from __future__ import annotations

from demo.count_up import count_up
from demo.goodbye import goodbye
from demo.greet import greet
from demo.say_once import say_once
from labkit.exercises import Choice, Lesson, Quiz, right, wrong

__all__ = ['LESSON']

LESSON = Lesson(
    'demo',
    'demo.ipynb',
    exercises=[count_up, greet, goodbye, say_once],
    quizzes=[
        Quiz(
            'numbers',
            Choice(
                'Which of these is odd?',
                right('3', '3 is not a multiple of 2.'),
                wrong('4', '4 is 2 times 2.'),
                wrong('0', '0 is 0 times 2, so it is even.'),
            ),
        )
    ],
    topics=['/demo_background'],
    given={'/background': '*'},
)
