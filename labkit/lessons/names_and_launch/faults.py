"""Exercise: a launch file with five faults: three stop it, and two are silent."""

from __future__ import annotations

from labkit.exercises import Exercise, Solution
from labkit.lessons.names_and_launch.launch_clauses import (
    HasParameters,
    Launches,
    OnlyNodes,
    Publishes,
)
from labkit.lessons.names_and_launch.learner_launch import Launched
from labkit.lessons.names_and_launch.system import DECLARED

__all__ = ['exercise']

FAULTS = (
    ('$(var robot)', '$(var name)'),
    ('exec="driver"', 'exec="drive"'),
    ('name="speed"', 'name="sped"'),
    ('<remap from="chatter"', '<remapp from="chater"'),
)
_SAYS = ('A robot with a driver and a talker', 'A robot with a driver, a talker ... and faults')
GIVEN = Solution(__file__, 'faults.ipy', '', (*FAULTS, _SAYS)).code.partition('\n')[2]

exercise = Exercise(
    name='faults',
    task='Mend faults.launch.xml, which has five faults.',
    clauses=(
        Launches('faults'),
        HasParameters(
            '/{robot}/driver',
            {'speed': 0.2, 'turn': -0.5},
            '`/amy/driver` runs, with a `speed` of 0.2 and a `turn` of -0.5',
            DECLARED,
        ),
        Publishes(
            '/{robot}/talker',
            '/{robot}/news',
            'chatter',
            '`/amy/talker` runs, and publishes on `/amy/news`',
        ),
        OnlyNodes(('/{robot}/driver', '/{robot}/talker'), 'no other node is started'),
    ),
    stage=Launched('faults', GIVEN, defaults={'robot': 'amy'}),
    hints=[
        'Launch it, read the line of the error, mend that line, and launch it again.',
        'Two faults raise no error. Compare ros2 param list and ros2 topic list with the file.',
        'The argument is called robot, the program driver, the tag remap, the parameter speed, '
        'and the topic in the code chatter.',
    ],
    answer=Solution(
        __file__,
        'faults.ipy',
        'Launch knows tags, arguments and programs, and tells what is wrong with them before it '
        'starts anything. It does not know the names in the code of a node: a parameter or a '
        'topic that is misspelt is silent.',
    ),
)
