"""The exercises and quizzes of `03_command_line.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.command_line import drive, odds
from labkit.lessons.command_line.harbour import NODES, TOPICS
from labkit.lessons.command_line.look_around import HARBOUR
from labkit.lessons.command_line.quiz import QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'command_line',
    '03_command_line.ipynb',
    title='The command line',
    minutes=60,
    teaches=(
        '`ros2` topics, nodes, messages and parameters from the command line; ROS 1 in ROS 2 words'
    ),
    exercises=[odds, drive],
    quizzes=[WARM_UP, HARBOUR, QUIZ],
    topics=[
        '/chatter',
        '/limit',
        *(f'/turtle{topic}' for topic in ROBOT_TOPICS),
        *ROBOT_TOPICS,
        *TOPICS,
    ],
    given={
        **dict.fromkeys(('/talker', '/listener', *NODES), ''),
        '/turtle/turtlebot': 'background',
        '/turtlebot': '*',
    },
)
