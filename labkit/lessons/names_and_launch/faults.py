"""Exercise: a launch file with five faults: three stop it, and two are silent."""

from __future__ import annotations

from labkit.exercises import Exercise, Solution, words_of
from labkit.lessons.names_and_launch.launch_clauses import (
    HasParameters,
    Launches,
    OnlyNodes,
    Publishes,
)
from labkit.lessons.names_and_launch.learner_launch import Launched
from labkit.lessons.names_and_launch.system import DECLARED

__all__ = ['exercise']

WORDS = words_of(__file__)

FAULTS = (
    ('$(var robot)', '$(var name)'),
    ('exec="driver"', 'exec="drive"'),
    ('name="speed"', 'name="sped"'),
    ('<remap from="chatter"', '<remapp from="chater"'),
)
_SAYS = ('A robot with a driver and a talker', 'A robot with a driver, a talker ... and faults')
GIVEN = Solution(__file__, 'faults.ipy', '', (*FAULTS, _SAYS)).code.partition('\n')[2]

exercise = Exercise(
    words=WORDS,
    clauses=(
        Launches('faults'),
        HasParameters(
            '/{robot}/driver',
            {'speed': 0.2, 'turn': -0.5},
            WORDS.clause('has-parameters'),
            DECLARED,
        ),
        Publishes(
            '/{robot}/talker',
            '/{robot}/news',
            'chatter',
            WORDS.clause('publishes'),
        ),
        OnlyNodes(('/{robot}/driver', '/{robot}/talker'), WORDS.clause('only-nodes')),
    ),
    stage=Launched('faults', GIVEN, defaults={'robot': 'amy'}),
)
