"""Exercise: a launch file that works with other arguments, too."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence

from labkit.exercises import Exercise, Fail, Mistake, Solution
from labkit.exercises.clauses import Asked
from labkit.lessons.names_and_launch.launch_clauses import (
    HasParameters,
    Launches,
    OnlyNodes,
    RunsNode,
)
from labkit.lessons.names_and_launch.learner_launch import Launched, System
from labkit.lessons.names_and_launch.system import DECLARED

__all__ = ['exercise']

DEFAULTS = {'robot': 'robot1', 'speed': '0.1', 'talk': 'false'}
_NAMES = ('amy', 'bo', 'rover7', 'tina')


def _draw() -> Sequence[Mapping[str, str]]:
    """Return no arguments at all, and then a value for each."""
    speed = f'0.{random.randint(12, 21)}'
    return [{}, {'robot': random.choice(_NAMES), 'speed': speed, 'talk': 'true'}]


ALWAYS = Mistake(
    'arguments/always',
    'It is there whether it is wanted or not: nothing asks the argument.',
    'if="$(var talk)" in the node',
    change=[(' if="$(var talk)"', '')],
)
NEVER = Mistake(
    'arguments/never',
    'The argument says true, and it is not there.',
    'if="$(var talk)" in the node',
    change=[('if="$(var talk)"', 'if="false"')],
)


def _talks_if_wanted(system: System) -> None:
    """Raise Fail if it is there and not wanted, or the other way round."""
    talker, wanted = f'/{system.values["robot"]}/talker', system.values['talk'] == 'true'
    if (talker in system.nodes) != wanted:
        raise Fail(
            f'{talker if wanted else "no talker"} with talk:={system.values["talk"]}',
            ', '.join(system.nodes),
            NEVER if wanted else ALWAYS,
        )


class _NothingElse(OnlyNodes):
    def judge(self, system: System) -> str:
        """Raise Fail if there is another node."""
        wanted = [*self.nodes, *['/{robot}/talker'] * (system.values['talk'] == 'true')]
        return OnlyNodes(wanted, self.words).judge(system)


exercise = Exercise(
    name='arguments',
    task='Write a launch file with the arguments robot, speed and talk.',
    clauses=(
        Launches('arguments'),
        RunsNode(
            '/{robot}/driver',
            'a driver runs in the namespace that `robot` says, by default `robot1`',
        ),
        HasParameters(
            '/{robot}/driver',
            {'speed': '{speed}'},
            'the argument `speed` is that of the driver, by default 0.1',
            DECLARED,
        ),
        Asked(
            '`talk`, `true` or `false` (the default), says whether a talker runs there, too',
            _talks_if_wanted,
        ),
        _NothingElse(('/{robot}/driver',), 'no other node is started'),
    ),
    stage=Launched('arguments', arguments=_draw, defaults=DEFAULTS),
    hints=[
        'Three tags <arg>, each with a default.',
        '$(var robot) stands for the value of an argument, wherever the file takes a value.',
        'if="$(var talk)" in a node starts it only if the argument is true.',
    ],
    answer=Solution(
        __file__,
        'arguments.ipy',
        'What may differ is an argument, and its default makes it optional. One group puts both '
        'nodes into the namespace.',
    ),
)
