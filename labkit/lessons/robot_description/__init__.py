"""The exercises and the quizzes of `15_robot_description.ipynb`."""

from __future__ import annotations

from labkit.exercises import Lesson
from labkit.lessons._robot import ROBOT_TOPICS
from labkit.lessons.robot_description import body, corner, ice, mounted
from labkit.lessons.robot_description.quiz import GUESSES, QUIZ, WARM_UP

__all__ = ['LESSON']

LESSON = Lesson(
    'robot_description',
    '15_robot_description.ipynb',
    title="A robot's body",
    minutes=75,
    teaches=(
        'a robot in three dimensions; its description in URDF and xacro: links, joints, origins; '
        'what robot_state_publisher makes of it; a sensor of its own; a world with physics'
    ),
    exercises=[body, mounted, corner, ice],
    quizzes=[WARM_UP, QUIZ],
    guesses=GUESSES,
    topics=[*ROBOT_TOPICS, '/tf', '/tf_static', '/base_pose_ground_truth'],
    given={
        '/turtlebot': '*',
        '/pilot': 'drive',
        '/joint_state_publisher': '*',
        '/rider': '*',
        '/teleop': '*',
    },
)
