"""Exercise: a launch file that works with other arguments, too."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from string import ascii_lowercase

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import Asked
from labkit.lessons.names_and_launch.launch_clauses import (
    HasParameters,
    Launches,
    OnlyNodes,
    RunsNode,
    refuse_missing,
)
from labkit.lessons.names_and_launch.learner_launch import Launched, System
from labkit.lessons.names_and_launch.system import DECLARED

__all__ = ['exercise']

WORDS = words_of(__file__)

DEFAULTS = {'robot': 'robot1', 'speed': '0.1', 'talk': 'false'}


def _draw() -> Sequence[Mapping[str, str]]:
    """Return no arguments at all, then a value for each, and then one alone."""
    speed = random.choice((f'0.{random.randint(12, 21)}', f'{random.randint(2, 9)}.5'))
    return [{}, {'robot': _name(), 'speed': speed, 'talk': 'true'}, {'talk': 'true'}]


def _name() -> str:
    """Return a name that no file can know."""
    letters = random.choices(ascii_lowercase, k=random.randint(2, 9))
    return f'{"".join(letters)}{random.choice(("", "_b", "7", "12"))}'


ALWAYS = WORDS.mistake('arguments/always')
NEVER = WORDS.mistake('arguments/never')


def _talks_if_wanted(system: System) -> None:
    """Raise Fail if it is there and not wanted, or the other way round."""
    talker, wanted = f'/{system.values["robot"]}/talker', system.values['talk'] == 'true'
    if wanted and any(node.endswith('/talker') for node in system.nodes):
        refuse_missing(system, talker, space='$(var robot)')
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
    words=WORDS,
    clauses=(
        Launches('arguments'),
        RunsNode(
            '/{robot}/driver',
            WORDS.clause('runs-node'),
        ),
        HasParameters(
            '/{robot}/driver',
            {'speed': '{speed}'},
            WORDS.clause('has-parameters'),
            DECLARED,
        ),
        Asked(
            WORDS.clause('talks-if-wanted'),
            _talks_if_wanted,
        ),
        _NothingElse(('/{robot}/driver',), WORDS.clause('nothing-else')),
    ),
    stage=Launched('arguments', arguments=_draw, defaults=DEFAULTS),
)
