"""Exercise: a node whose rate is a parameter with a range, and changes while it runs."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Probe, Solution
from labkit.exercises.clauses import OFF, Follows, GraphClause, HasParameter, Named, Refuses
from labkit.exercises.clauses.parameter_client import Values
from labkit.exercises.draws import draw_float
from labkit.exercises.variants import varied

__all__ = ['exercise']

TOPIC, EMPTY = '/tick', 'std_msgs/msg/Empty'
NODE = '/metronome'
LIMITS = 1.0, 20.0


def _rates(low: float, high: float) -> Sequence[Values]:
    """Return a rate that is no whole number, and both limits of the range."""
    rates = [draw_float(3.0, 9.0), low, high]
    random.shuffle(rates)
    return [{'rate': rate} for rate in rates]


def _bad_rates(low: float, high: float) -> tuple[Values, Sequence[Values]]:
    bad: list[object] = [
        draw_float(0.1 * low, 0.9 * low),
        low - 0.001,
        high + 0.001,
        draw_float(high + 0.5, high + 100.0),
        draw_float(-15.0, -2.0),
        0.0,
        math.nan,
        math.inf,
        5,
        'fast',
    ]
    return {'rate': random.choice([low, 2.5, 6.25])}, [{'rate': value} for value in bad]


def _clauses(low: float, high: float) -> tuple[GraphClause, ...]:
    follows = Follows(
        NODE,
        TOPIC,
        f'publish `{EMPTY}` on `{TOPIC}`, `rate` times a second ({OFF}), also after '
        'each change of `rate`',
        lambda: _rates(low, high),
        hz=lambda values: float(values['rate']),
    )
    return (
        Named(NODE),
        HasParameter(
            NODE,
            'rate',
            float,
            f'its parameter `rate` is a double with a range from {low} to {high} and a '
            'description',
            (low, high),
        ),
        follows,
        Refuses(
            NODE,
            'values outside the range, `nan` and values of another type are refused, with a '
            'reason, and change nothing',
            lambda: _bad_rates(low, high),
            follows,
        ),
    )


def _variant(*, low: float = LIMITS[0], high: float = LIMITS[1]) -> Exercise:
    return Exercise(
        name='metronome',
        task=f'Publish Empty on {TOPIC} at a rate that is a parameter, from {low} to {high}, and '
        'changes while the node runs.',
        publishes={TOPIC: EMPTY},
        clauses=_clauses(low, high),
        hints=[
            'A range in the descriptor is looked at by ROS: what is outside is refused.',
            'A timer keeps its period. Which callback is called after a parameter was set?',
            'In the callback of add_post_set_parameters_callback(): destroy_timer(self.timer), '
            'and make a new one with the period 1.0 / parameter.value.',
        ],
        answer=Solution(
            __file__,
            'metronome.py',
            'The range is in the descriptor, so ROS refuses, and anybody can read it. The '
            'callback after the change makes a new timer. It looks at the name: every parameter '
            'comes here.',
        ).changed(('from_value=1.0, to_value=20.0', f'from_value={low}, to_value={high}')),
    )


def _guess(probe: Probe) -> dict[str, float] | None:
    from labkit.asking.parameter_calls import describe_parameters, parameter_names

    if NODE not in probe.node_names() or 'rate' not in parameter_names(probe.spun_node, NODE):
        return None
    found = describe_parameters(probe.spun_node, NODE, ['rate'])[0].floating_point_range
    return {'low': found[0].from_value, 'high': found[0].to_value} if found else None


exercise = varied(
    _variant(),
    _variant,
    _guess,
    low=(0.5, 0.6, 0.7, 0.8, 1.2, 1.4, 1.5, 1.6),
    high=[float(number) for number in range(14, 46) if number != 20],
)
