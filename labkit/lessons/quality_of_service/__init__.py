"""The exercises and the quiz of `08_quality_of_service.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons.quality_of_service import door, silent_mast, site, watchdog
from labkit.lessons.quality_of_service.lock import NODE as LOCK
from labkit.lessons.quality_of_service.masts import NODES
from labkit.lessons.quality_of_service.quiz import GUESSES, QUIZ, WARM_UP
from labkit.lessons.quality_of_service.rover import NODE as ROVER
from labkit.lessons.quality_of_service.rover import TOPICS

__all__ = ['LESSON']

LESSON = Lesson(
    'quality_of_service',
    '08_quality_of_service.ipynb',
    title='Quality of service',
    minutes=80,
    teaches=(
        'depth, reliability, durability, lifespan, deadline; two ends that do not match, '
        'and where ROS tells'
    ),
    exercises=[site, watchdog, silent_mast, door],
    quizzes=[WARM_UP, QUIZ],
    guesses=GUESSES,
    topics=['/frames', *TOPICS, '/numbers', '/fresh', '/kept', '/beat', '/range', '/display'],
    given={
        '/camera': 'slow',
        '/viewer': 'slow',
        '/base': 'rover',
        ROVER: '',
        '/speaker': 'late-joiner',
        '/late': 'late-joiner',
        '/robot': 'lifespan',
        '/driver': 'lifespan',
        '/clock': 'lifespan',
        '/heart': 'deadline',
        '/nurse': 'deadline',
        '/sonar': 'silent',
        '/pilot': 'silent repair',
        **dict.fromkeys(NODES, ''),
        '/old_door': 'lock',
        LOCK: 'lock',
    },
)
