"""Exercise: change the period of a timer."""

from __future__ import annotations

from labkit.exercises import Exercise, Solution
from labkit.exercises.clauses import Publishes

__all__ = ['four_a_second']

STRING = 'std_msgs/msg/String'


four_a_second = Exercise(
    name='four_a_second',
    task='Set the period so that `Beacon` publishes on /beacon four times a second.',
    clauses=(Publishes('/beacon', 4.0, STRING),),
    hints=[
        'create_timer() takes a period: the seconds from one call to the next. It is no rate.',
        'Four calls in one second: how long does each of them have?',
        'The period is 1 divided by the rate: 1 / 4.',
    ],
    answer=Solution(
        __file__,
        'four_a_second.py',
        'The rate is 4 Hz, which means four times a second. The period is 1 / rate, 0.25 s.',
    ),
)
