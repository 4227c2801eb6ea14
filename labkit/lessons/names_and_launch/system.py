"""Exercise: three nodes as asked, with namespaces, a name, remaps and a parameter."""

from __future__ import annotations

from labkit.exercises import Exercise, Solution
from labkit.lessons.names_and_launch.launch_clauses import (
    HasParameters,
    Hears,
    Launches,
    OnlyNodes,
    Publishes,
)
from labkit.lessons.names_and_launch.learner_launch import Launched

__all__ = ['DECLARED', 'exercise']

# The parameters of the driver, with the values that its code declares.
DECLARED = {'speed': 0.1, 'turn': 0.5}

exercise = Exercise(
    name='system',
    task='Write a launch file for a speaker, a listener and a driver.',
    clauses=(
        Launches('system'),
        Publishes(
            '/tower/speaker',
            '/tower/news',
            'chatter',
            'a talker runs as `/tower/speaker`, and publishes on `/tower/news`',
        ),
        Hears(
            '/tower/listener',
            '/tower/news',
            'chatter',
            'a listener runs as `/tower/listener`, and subscribes to `/tower/news`',
        ),
        HasParameters(
            '/robot1/driver',
            {'speed': 0.15, 'turn': 0.5},
            'a driver runs as `/robot1/driver`, with a `speed` of 0.15 and its declared `turn`',
            DECLARED,
        ),
        OnlyNodes(
            ('/tower/speaker', '/tower/listener', '/robot1/driver'),
            'no other node is started',
        ),
    ),
    stage=Launched('system'),
    hints=[
        'Three tags <node>. Each needs pkg, exec and namespace, and one of them a name.',
        'The code of talker and listener says chatter. A tag <remap> inside of the node changes '
        'that, in both.',
        '<remap from="chatter" to="news"/>, and <param name="speed" value="0.15"/> in the driver. '
        'The turn needs no line.',
    ],
    answer=Solution(
        __file__,
        'system.ipy',
        'Relative names stay in the namespace of their node: chatter becomes news, and news '
        'becomes /tower/news. What the file does not set stays as it is in the code.',
    ),
)
