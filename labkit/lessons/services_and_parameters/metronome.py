"""Exercise: a node whose rate is a parameter with a range, and changes while it runs."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Probe, Solution, words_of
from labkit.exercises.clauses import OFF, Follows, GraphClause, HasParameter, Named, Refuses
from labkit.exercises.clauses.parameter_client import Values
from labkit.exercises.draws import draw_float
from labkit.exercises.variants import varied
from labkit.exercises.words import Words

__all__ = ['exercise']

WORDS = words_of(__file__)

TOPIC, EMPTY = '/tick', 'std_msgs/msg/Empty'
NODE = '/metronome'
LIMITS = 1.0, 20.0


def _rates(low: float, high: float) -> Sequence[Values]:
    """Return some rates that are no whole numbers, and both limits of the range."""
    rates = [draw_float(3.0, 9.0), low, high]
    random.shuffle(rates)
    rates += [draw_float(3.0, 9.0) for _ in range(random.randint(1, 2))]
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


def _clauses(words: Words, low: float, high: float) -> tuple[GraphClause, ...]:
    follows = Follows(
        NODE,
        TOPIC,
        words.clause('follows'),
        lambda: _rates(low, high),
        hz=lambda values: float(values['rate']),
    )
    return (
        Named(NODE),
        HasParameter(NODE, 'rate', float, words.clause('has-parameter'), (low, high)),
        follows,
        Refuses(NODE, words.clause('refuses'), lambda: _bad_rates(low, high), follows),
    )


def _variant(*, low: float = LIMITS[0], high: float = LIMITS[1]) -> Exercise:
    # As Python and YAML have a double: without a point it is an integer, and refused.
    words = WORDS.of(low=str(low), high=str(high), off=OFF)
    return Exercise(
        words=words,
        publishes={TOPIC: EMPTY},
        clauses=_clauses(words, low, high),
        answer=Solution.of(words).changed(
            ('from_value=1.0, to_value=20.0', f'from_value={low}, to_value={high}')
        ),
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
