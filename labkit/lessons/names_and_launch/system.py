"""Exercise: three nodes as asked, with namespaces, a name, remaps and a parameter."""

from __future__ import annotations

from labkit.exercises import Exercise, words_of
from labkit.lessons.names_and_launch.launch_clauses import (
    HasParameters,
    Hears,
    Launches,
    OnlyNodes,
    Publishes,
)
from labkit.lessons.names_and_launch.learner_launch import Launched

__all__ = ['DECLARED', 'exercise']

WORDS = words_of(__file__)

# The parameters of the driver, with the values that its code declares.
DECLARED = {'speed': 0.1, 'turn': 0.5}

exercise = Exercise(
    words=WORDS,
    clauses=(
        Launches('system'),
        Publishes(
            '/tower/speaker',
            '/tower/news',
            'chatter',
            WORDS.clause('publishes'),
        ),
        Hears(
            '/tower/listener',
            '/tower/news',
            'chatter',
            WORDS.clause('hears'),
        ),
        HasParameters(
            '/robot1/driver',
            {'speed': 0.15, 'turn': 0.5},
            WORDS.clause('has-parameters'),
            DECLARED,
        ),
        OnlyNodes(
            ('/tower/speaker', '/tower/listener', '/robot1/driver'),
            WORDS.clause('only-nodes'),
        ),
    ),
    stage=Launched('system'),
)
