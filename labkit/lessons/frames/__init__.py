"""The exercises and the quizzes of `14_frames.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.frames import mend, mount, nearest, reach, wheels
from labkit.lessons.frames.quiz import GUESSES, QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'frames',
    '14_frames.ipynb',
    title='Frames',
    minutes=90,
    teaches=(
        'where things are: frames, the tree of transforms, looking up now and in the past, what '
        'tf2 says if it cannot; odometry from the wheels'
    ),
    exercises=[mount, nearest, reach, mend, wheels],
    quizzes=[WARM_UP, QUIZ],
    guesses=GUESSES,
    topics=[*ROBOT_TOPICS, '/tf', '/tf_static'],
    given={'/turtlebot': '*', '/arm': 'arm', '/frames_listener': 'listener'},
)
