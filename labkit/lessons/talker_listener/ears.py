"""Exercise: two nodes publish on one topic."""

from __future__ import annotations

from labkit.exercises import Exercise, Solution
from labkit.exercises.clauses import HasText, NobodyElse, Publishes

__all__ = ['exercise']

STRING = 'std_msgs/msg/String'
EARS = ('/left_ear', '/right_ear')


exercise = Exercise(
    name='ears',
    task='Two nodes, left_ear and right_ear, publish text on /sound five times a second each.',
    shared=['/sound'],
    nodes=EARS,
    clauses=(
        *(Publishes('/sound', 5.0, STRING, by=ear) for ear in EARS),
        HasText('/sound', by=EARS),
        NobodyElse('/sound', EARS),
    ),
    hints=[
        'The class Talker of this lesson is nearly an Ear. What differs: topic and period.',
        'Five times a second is a period of 0.2 s.',
        "One class, two nodes: lab.spin(Ear('left_ear')) and lab.spin(Ear('right_ear')).",
    ],
    answer=Solution(
        __file__,
        'ears.py',
        'A class describes a kind of node. The name makes the difference between two nodes of '
        'that kind, so it is passed when the node is made.',
    ),
)
