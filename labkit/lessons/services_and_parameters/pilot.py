"""Exercise: a driver in a file, with two parameters, of which one is the limit of the other."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Fail, expect, words_of
from labkit.exercises.clauses import (
    OFF,
    Follows,
    HasParameter,
    Refuses,
    Stream,
    in_words,
)
from labkit.exercises.clauses.parameter_client import Values
from labkit.exercises.draws import draw_float, draw_size
from labkit.lessons._terminal import RunsFile

__all__ = ['exercise']

WORDS = words_of(__file__)

TOPIC, TWIST = '/cmd_vel', 'geometry_msgs/msg/Twist'
NODE = '/pilot'
HZ = 10.0

MORE_FIELDS = WORDS.mistake('pilot/more-fields')
AT_THE_LIMIT = WORDS.mistake('pilot/at-the-limit')


def _draw() -> Sequence[Values]:
    """Return pairs: the second speed is above the first limit, the last at the edge, one large."""
    low = draw_float(0.05, 0.1)
    high = draw_float(0.15, 0.2)
    return [
        {'speed': draw_float(0.01, low), 'limit': low},
        {'limit': draw_float(high, 0.22), 'speed': high},
        {'speed': draw_size(0.5, 50.0), 'limit': draw_float(51.0, 900.0)},
        {'speed': 0.0, 'limit': 0.0},
    ]


def _bad() -> tuple[Values, Sequence[Values]]:
    speed, limit = draw_float(0.05, 0.1), draw_float(0.12, 0.2)
    bad: list[Values] = [
        {'speed': round(limit + 0.001, 3)},
        {'speed': draw_float(limit + 0.1, limit + 1.0)},
        {'speed': draw_size(2.0, 900.0)},
        {'speed': math.inf},
        {'speed': -0.001},
        {'speed': draw_float(-1.0, -0.01)},
        {'limit': round(speed - 0.001, 3)},
        {'limit': draw_float(-1.0, -0.01)},
        {'speed': -0.05, 'limit': 0.1},
        {'speed': math.nan},
        {'limit': math.nan},
        {'speed': draw_float(0.5, 0.9), 'limit': draw_float(0.3, 0.4)},
    ]
    random.shuffle(bad)
    return {'speed': speed, 'limit': limit}, bad


def _says_speed(values: Values, stream: Stream) -> None:
    wanted = [values['speed'], *[0.0] * 5]
    for sample in stream.samples:
        msg = sample.message
        seen = [getattr(part, axis) for part in (msg.linear, msg.angular) for axis in 'xyz']
        if seen != wanted:
            # If neither fits, it may be the speed of before.
            mistake = AT_THE_LIMIT if seen[0] == values['limit'] else None
            raise Fail(
                f'linear.x = {values["speed"]}, all else 0.0, in each message on {TOPIC}',
                f'linear and angular: {expect.show(seen)}',
                MORE_FIELDS if any(seen[1:]) else mistake,
            )


_FOLLOWS = Follows(
    NODE,
    TOPIC,
    WORDS.of(times=in_words(HZ), off=OFF).clause('follows'),
    _draw,
    hz=lambda _: HZ,
    rule=_says_speed,
)

exercise = Exercise(
    words=WORDS,
    publishes={TOPIC: TWIST},
    reliable=[TOPIC],
    clauses=(
        RunsFile('nodes/pilot.py', [NODE]),
        HasParameter(NODE, 'speed', float, WORDS.clause('has-parameter')),
        HasParameter(NODE, 'limit', float, WORDS.clause('has-parameter-2')),
        _FOLLOWS,
        Refuses(
            NODE,
            WORDS.clause('refuses'),
            _bad,
            _FOLLOWS,
        ),
    ),
)
