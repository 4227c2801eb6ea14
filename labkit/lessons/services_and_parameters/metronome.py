"""Exercise: a node whose rate is a parameter with a range, and changes while it runs."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from labkit.exercises import Exercise, Probe, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Clause, Follows, HasParameter, Named, Refuses
from labkit.exercises.clauses.parameter_client import Values
from labkit.exercises.draws import draw_float
from labkit.exercises.variants import varied
from labkit.lessons._script import in_process, started_by_subprocess

__all__ = ['metronome']

TOPIC, EMPTY = '/tick', 'std_msgs/msg/Empty'
NODE = '/metronome'
LIMITS = 1.0, 20.0

_METRONOME = """
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node
from std_msgs.msg import Empty


class Metronome(Node):
    def __init__(self):
        super().__init__('metronome')
        descriptor = ParameterDescriptor(
            description='Ticks a second, in Hz',
            floating_point_range=[FloatingPointRange(from_value=1.0, to_value=20.0)],
        )
        self.declare_parameter('rate', 2.0, descriptor)
        self.publisher = self.create_publisher(Empty, 'tick', 10)
        self.start_timer(2.0)
        self.add_post_set_parameters_callback(self.on_change)

    def start_timer(self, rate):
        self.timer = self.create_timer(1.0 / rate, self.on_timer)

    def on_change(self, parameters):
        for parameter in parameters:
            if parameter.name == 'rate':
                self.destroy_timer(self.timer)
                self.start_timer(parameter.value)

    def on_timer(self):
        self.publisher.publish(Empty())


lab.spin(Metronome())
"""
_RANGE = '            floating_point_range=[FloatingPointRange(from_value=1.0, to_value=20.0)],\n'
_CHANGE = """                self.destroy_timer(self.timer)
                self.start_timer(parameter.value)
"""
_POST = '        self.add_post_set_parameters_callback(self.on_change)\n'


def _rates(low: float = LIMITS[0], high: float = LIMITS[1]) -> Sequence[Values]:
    """Return a rate that is no whole number, and a limit of the range."""
    rates = [draw_float(3.0, 9.0), random.choice([low, high, 12.5])]
    random.shuffle(rates)
    return [{'rate': rate} for rate in rates]


def _bad_rates(low: float = LIMITS[0], high: float = LIMITS[1]) -> tuple[Values, Sequence[Values]]:
    bad: list[object] = [
        draw_float(0.1 * low, 0.9 * low),
        draw_float(high + 0.5, high + 100.0),
        draw_float(-15.0, -2.0),
        math.nan,
        math.inf,
        5,
        'fast',
    ]
    return {'rate': random.choice([low, 2.5, 6.25])}, [{'rate': value} for value in bad]


def _clauses(low: float = LIMITS[0], high: float = LIMITS[1]) -> tuple[Clause, ...]:
    follows = Follows(
        NODE,
        TOPIC,
        f'publish `{EMPTY}` on `{TOPIC}`, `rate` times a second (up to 2 % off), also after '
        'each change of `rate`',
        partial(_rates, low, high),
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
            'values out of the range, `nan` and values of another type are refused, with a '
            'reason, and change nothing',
            partial(_bad_rates, low, high),
            follows,
        ),
    )


_USUAL = Exercise(
    name='metronome',
    task='Publish Empty on /tick at a rate that is a parameter, and changes while the node runs.',
    publishes={TOPIC: EMPTY},
    nodes=[NODE],
    clauses=_clauses(),
    hints=[
        'A range in the descriptor is looked at by ROS: what is outside is refused.',
        'A timer keeps its period. Which callback is called after a parameter was set?',
        'In the callback of add_post_set_parameters_callback(): destroy_timer(self.timer), and '
        'make a new one with the period 1.0 / parameter.value.',
    ],
    answer=Solution(
        _METRONOME,
        'The range is in the descriptor, so ROS refuses, and anybody can read it. The callback '
        'after the change makes a new timer. It looks at the name: every parameter comes here.',
    ),
    styles=[
        Style(
            'another period for the same timer',
            changed(
                _METRONOME,
                (
                    _CHANGE,
                    '                self.timer.timer_period_ns = int(1e9 / parameter.value)\n',
                ),
            ),
        ),
        Style(
            'looks at each tick',
            changed(
                _METRONOME,
                (_POST, ''),
                (
                    '        self.publisher.publish(Empty())\n',
                    '        self.publisher.publish(Empty())\n'
                    "        period = int(1e9 / self.get_parameter('rate').value)\n"
                    '        if self.timer.timer_period_ns != period:\n'
                    '            self.timer.timer_period_ns = period\n'
                    '            self.timer.reset()\n',
                ),
            ),
        ),
        Style(
            'a callback that only looks, besides',
            changed(
                _METRONOME,
                (_POST, f'{_POST}        self.add_on_set_parameters_callback(self.on_set)\n'),
                (
                    '    def on_timer',
                    '    def on_set(self, parameters):\n'
                    '        good = all(p.value is not None for p in parameters)\n'
                    "        return SetParametersResult(successful=good, reason='no value')\n\n"
                    '    def on_timer',
                ),
                ('ParameterDescriptor\n', 'ParameterDescriptor, SetParametersResult\n'),
            ),
        ),
        Style('own process, started here', started_by_subprocess(in_process(_METRONOME))),
        Style('own process', in_process(_METRONOME), process=True),
    ],
    wrong=[
        Wrong(
            'begins with another rate',
            changed(_METRONOME, ('start_timer(2.0)', 'start_timer(4.0)')),
            'with rate = 2.0',
        ),
        Wrong(
            'another node name',
            changed(_METRONOME, ("__init__('metronome'", "__init__('metronom'")),
            'The name is what super().__init__() gets',
        ),
        Wrong(
            'reacts before it is decided',
            changed(
                _METRONOME,
                ('add_post_set', 'add_pre_set'),
                (
                    _CHANGE,
                    '                value = parameter.value\n'
                    '                if isinstance(value, float) and 0.0 < value < 50.0:\n'
                    '                    self.destroy_timer(self.timer)\n'
                    '                    self.start_timer(value)\n'
                    '        return parameters\n',
                ),
            ),
            'The node has refused a value, and uses it all the same.',
        ),
        Wrong(
            'no reaction',
            changed(_METRONOME, (_POST, '')),
            'The parameter has changed, and what the node does has not',
        ),
        Wrong(
            'no range',
            changed(_METRONOME, (_RANGE, '')),
            'A range in the descriptor is checked by ROS itself',
        ),
        Wrong(
            'another range',
            changed(_METRONOME, ('to_value=20.0', 'to_value=10.0')),
            'a range from 1.0 to 10.0',
        ),
        Wrong(
            'no description',
            changed(_METRONOME, ("            description='Ticks a second, in Hz',\n", '')),
            'a descriptor without a description',
        ),
        Wrong(
            'an integer',
            changed(
                _METRONOME,
                ("'rate', 2.0", "'rate', 2"),
                (
                    _RANGE,
                    '            integer_range=[IntegerRange(from_value=1, to_value=20)],\n',
                ),
                ('FloatingPointRange,', 'IntegerRange,'),
            ),
            '2 is an integer, 2.0 a double',
        ),
        Wrong(
            'any type',
            changed(
                _METRONOME,
                (_RANGE, f'{_RANGE}            dynamic_typing=True,\n'),
            ),
            'dynamic_typing is on',
        ),
        Wrong(
            'another name',
            changed(_METRONOME, ("'rate'", "'rates'")),
            'rates is not rate',
        ),
        Wrong(
            'not declared',
            changed(
                _METRONOME,
                ("self.declare_parameter('rate', 2.0, descriptor)", 'self.about = descriptor'),
            ),
            'A node has the parameters that it declares',
        ),
        Wrong(
            'rate for period',
            changed(_METRONOME, ('create_timer(1.0 / rate,', 'create_timer(rate,')),
            'A rate in Hz and a period in seconds were mixed up',
        ),
        Wrong(
            'the old timer goes on',
            changed(_METRONOME, ('                self.destroy_timer(self.timer)\n', '')),
            'times too fast',
        ),
        Wrong(
            'refuses what is allowed',
            changed(
                _METRONOME,
                (_POST, f'{_POST}        self.add_on_set_parameters_callback(self.on_set)\n'),
                (
                    '    def on_timer',
                    '    def on_set(self, parameters):\n'
                    "        return SetParametersResult(successful=False, reason='no')\n\n"
                    '    def on_timer',
                ),
                ('ParameterDescriptor\n', 'ParameterDescriptor, SetParametersResult\n'),
            ),
            'a node that refuses them can not be used',
        ),
        Wrong(
            'asked, and says nothing',
            changed(
                _METRONOME,
                (_POST, f'{_POST}        self.add_on_set_parameters_callback(self.on_set)\n'),
                ('    def on_timer', '    def on_set(self, parameters): ...\n\n    def on_timer'),
            ),
            'return SetParametersResult(successful=True)',
        ),
        Wrong(
            'not spun',
            changed(_METRONOME, ('lab.spin(Metronome())', 'Metronome()')),
            'Hand the node over: lab.spin(node)',
        ),
        Wrong(
            'no reaction, in a process of its own',
            changed(in_process(_METRONOME), (_POST, '')),
            'The parameter has changed, and what the node does has not',
            process=True,
        ),
    ],
)


def _variant(*, low: float, high: float) -> Exercise:
    code = changed(
        _METRONOME, ('from_value=1.0, to_value=20.0', f'from_value={low}, to_value={high}')
    )
    return replace(
        _USUAL,
        task=f'Publish Empty on /tick at a rate that is a parameter, from {low} to {high}, and '
        'changes while the node runs.',
        clauses=_clauses(low, high),
        answer=Solution(code, _USUAL.answer.reason),
        styles=(),
        wrong=(),
    )


def _guess(probe: Probe) -> dict[str, float] | None:
    from labkit.background.parameters import describe_parameters, parameter_names

    if NODE not in probe.node_names() or 'rate' not in parameter_names(probe.spun_node, NODE):
        return None
    found = describe_parameters(probe.spun_node, NODE, ['rate'])[0].floating_point_range
    return {'low': found[0].from_value, 'high': found[0].to_value} if found else None


metronome = varied(
    _USUAL,
    _variant,
    _guess,
    low=(0.5, 0.6, 0.7, 0.8, 1.2, 1.4, 1.5, 1.6),
    high=[float(number) for number in range(14, 46) if number != 20],
)
