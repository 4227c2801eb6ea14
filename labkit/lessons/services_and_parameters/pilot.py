"""Exercise: a driver with two parameters, of which one is the limit of the other."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Fail, Mistake, Solution, expect
from labkit.exercises.clauses import (
    OFF,
    Follows,
    HasParameter,
    Named,
    Refuses,
    Stream,
    in_words,
)
from labkit.exercises.clauses.parameter_client import Values
from labkit.exercises.draws import draw_float

__all__ = ['exercise']

TOPIC, TWIST = '/cmd_vel', 'geometry_msgs/msg/Twist'
NODE = '/pilot'
HZ = 10.0

MORE_FIELDS = Mistake(
    'pilot/more-fields',
    'Only linear.x is asked for. Another field makes the robot do something else.',
    'Leave the other fields as they are in a new message.',
    change=[('        msg = Twist()\n', '        msg = Twist()\n        msg.angular.z = 0.5\n')],
)
AT_THE_LIMIT = Mistake(
    'pilot/at-the-limit',
    'That is the limit, and not the speed.',
    'Put the parameter speed into linear.x.',
    change=[("self.get_parameter('speed')", "self.get_parameter('limit')")],
)


def _draw() -> Sequence[Values]:
    """Return pairs: the second speed is above the first limit, and some are at an edge."""
    low = draw_float(0.05, 0.1)
    high = draw_float(0.15, 0.2)
    return [
        {'speed': draw_float(0.01, low), 'limit': low},
        {'limit': draw_float(high, 0.22), 'speed': high},
        {'speed': low, 'limit': low},
        {'speed': 0.0, 'limit': 0.0},
    ]


def _bad() -> tuple[Values, Sequence[Values]]:
    speed, limit = draw_float(0.05, 0.1), draw_float(0.12, 0.2)
    bad: list[Values] = [
        {'speed': round(limit + 0.001, 3)},
        {'speed': draw_float(limit + 0.1, limit + 1.0)},
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
    f'publish `{TWIST}` on `{TOPIC}`, {in_words(HZ)} times a second ({OFF}); `linear.x` is '
    'always `speed`, all else 0.0',
    _draw,
    hz=lambda _: HZ,
    rule=_says_speed,
)

exercise = Exercise(
    name='pilot',
    task='Drive at a speed that is a parameter, and refuse what is above the limit, which is '
    'another one.',
    publishes={TOPIC: TWIST},
    reliable=[TOPIC],
    clauses=(
        Named(NODE),
        HasParameter(NODE, 'speed', float, 'its parameter `speed` is a double with a description'),
        HasParameter(NODE, 'limit', float, 'its parameter `limit` is a double with a description'),
        _FOLLOWS,
        Refuses(
            NODE,
            'values that make `speed` negative or more than `limit`, and `nan`, are refused, with '
            'a reason, and change nothing',
            _bad,
            _FOLLOWS,
        ),
    ),
    hints=[
        'A range has fixed ends. Here the limit may change, so a callback has to decide.',
        'The callback of add_on_set_parameters_callback() gets all parameters that are set at '
        'once. What is not among them keeps its value: self.get_parameter(name).value',
        'Put both values into a dictionary, the old ones first, then the new ones. Allow them if '
        '0.0 <= speed <= limit: with nan that is False.',
    ],
    answer=Solution(
        __file__,
        'pilot.py',
        'The callback looks at the values as they would be after the change: old ones, and on top '
        'of them the new ones. It asks what is allowed, and not what is forbidden, so nan does '
        'not slip through. The timer reads the parameter anew each time.',
    ),
)
