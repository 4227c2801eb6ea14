"""Exercise: a driver with two parameters, of which one is the limit of the other."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

from labkit.exercises import Exercise, Fail, Outcome, Solution, Style, Wrong, changed, expect
from labkit.exercises.clauses import Follows, HasParameter, Named, Refuses, Stream
from labkit.exercises.clauses.parameter_client import Values
from labkit.exercises.draws import draw_float
from labkit.lessons._script import in_process, started_by_subprocess

__all__ = ['pilot']

TOPIC, TWIST = '/cmd_vel', 'geometry_msgs/msg/Twist'
NODE = '/pilot'
HZ = 10.0

_PILOT = """
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.node import Node


class Pilot(Node):
    def __init__(self, **kwargs):
        super().__init__('pilot', **kwargs)
        self.declare('speed', 0.05, 'Speed ahead, in m/s')
        self.declare('limit', 0.1, 'Greatest speed, in m/s')
        self.add_on_set_parameters_callback(self.on_set)
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.on_timer)

    def declare(self, name, value, description):
        self.declare_parameter(name, value, ParameterDescriptor(description=description))

    def on_set(self, parameters):
        values = {name: self.get_parameter(name).value for name in ('speed', 'limit')}
        values.update({p.name: p.value for p in parameters if p.name in values})
        if 0.0 <= values['speed'] <= values['limit']:
            return SetParametersResult(successful=True)
        return SetParametersResult(successful=False, reason='speed must be from 0.0 to limit')

    def on_timer(self):
        msg = Twist()
        msg.linear.x = self.get_parameter('speed').value
        self.publisher.publish(msg)


lab.spin(Pilot())
"""
_CHECK = """        values = {name: self.get_parameter(name).value for name in ('speed', 'limit')}
        values.update({p.name: p.value for p in parameters if p.name in values})
        if 0.0 <= values['speed'] <= values['limit']:
"""
_CALLBACK = '        self.add_on_set_parameters_callback(self.on_set)\n'


def _draw() -> Sequence[Values]:
    """Return pairs in which the second speed is above the first limit: they go together."""
    low = draw_float(0.05, 0.1)
    high = draw_float(0.15, 0.2)
    return [
        {'speed': draw_float(0.01, low), 'limit': low},
        {'speed': high, 'limit': draw_float(high, 0.22)},
    ]


def _bad() -> tuple[Values, Sequence[Values]]:
    speed, limit = draw_float(0.05, 0.1), draw_float(0.12, 0.2)
    bad: list[Values] = [
        {'speed': draw_float(limit + 0.001, limit + 1.0)},
        {'speed': draw_float(-1.0, -0.01)},
        {'limit': draw_float(0.0, speed - 0.001)},
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
            raise Fail(
                f'linear.x = {values["speed"]}, all else 0.0, in each message on {TOPIC}',
                f'linear and angular: {expect.show(seen)}',
                why=_speed_trouble(seen, values),
            )


def _speed_trouble(seen: Sequence[float], values: Values) -> str:
    """Say what is wrong with a command; '' if it may be the speed of before."""
    if any(seen[1:]):
        return 'Only linear.x is asked for. Another field makes the robot do something else.'
    if seen[0] == values['limit']:
        return 'That is the limit, and not the speed.'
    return ''


_FOLLOWS = Follows(
    NODE,
    TOPIC,
    f'publish `{TWIST}` on `{TOPIC}`, ten times a second (up to 2 % off): `linear.x` is '
    '`speed`, also after each change, all else 0.0',
    _draw,
    hz=lambda _: HZ,
    rule=_says_speed,
)

pilot = Exercise(
    name='pilot',
    task='Drive at a speed that is a parameter, and refuse what is above the limit, which is '
    'another one.',
    publishes={TOPIC: TWIST},
    nodes=[NODE],
    reliable=[TOPIC],
    clauses=(
        Named(NODE),
        HasParameter(NODE, 'speed', float, 'its parameter `speed` is a double with a description'),
        HasParameter(NODE, 'limit', float, 'its parameter `limit` is a double with a description'),
        _FOLLOWS,
        Refuses(
            NODE,
            'what would make `speed` less than 0.0 or more than `limit`, and `nan`, is refused, '
            'with a reason, and changes nothing',
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
        _PILOT,
        'The callback looks at the values as they would be after the change: old ones, and on top '
        'of them the new ones. It asks what is allowed, and not what is forbidden, so nan does '
        'not slip through. The timer reads the parameter anew each time.',
    ),
    styles=[
        Style(
            'keeps the speed in an attribute',
            changed(
                _PILOT,
                (
                    _CALLBACK,
                    f'{_CALLBACK}        self.add_post_set_parameters_callback(self.on_change)\n'
                    '        self.speed = 0.05\n',
                ),
                (
                    '    def on_timer',
                    '    def on_change(self, parameters):\n'
                    "        self.speed = self.get_parameter('speed').value\n\n"
                    '    def on_timer',
                ),
                ("msg.linear.x = self.get_parameter('speed').value", 'msg.linear.x = self.speed'),
            ),
        ),
        Style(
            'asks what is forbidden, and for nan',
            changed(
                _PILOT,
                (
                    "        if 0.0 <= values['speed'] <= values['limit']:\n",
                    "        speed, limit = values['speed'], values['limit']\n"
                    '        bad = math.isnan(speed) or math.isnan(limit)\n'
                    '        if not (bad or speed < 0.0 or speed > limit):\n',
                ),
                ('from geometry', 'import math\n\nfrom geometry'),
            ),
        ),
        Style(
            'a range for the lower end, besides',
            changed(
                _PILOT,
                (
                    '        self.declare_parameter(name, value, '
                    'ParameterDescriptor(description=description))\n',
                    '        positive = FloatingPointRange(from_value=0.0, to_value=1000.0)\n'
                    '        descriptor = ParameterDescriptor('
                    'description=description, floating_point_range=[positive])\n'
                    '        self.declare_parameter(name, value, descriptor)\n',
                ),
                (
                    'import ParameterDescriptor, SetParametersResult\n',
                    'import FloatingPointRange, ParameterDescriptor, SetParametersResult\n',
                ),
            ),
        ),
        Style(
            'with values from its command line',
            changed(
                _PILOT,
                (
                    'lab.spin(Pilot())',
                    "lab.spin(Pilot(cli_args=['--ros-args', '-p', 'limit:=0.22']))",
                ),
            ),
        ),
        Style('own process, started here', started_by_subprocess(in_process(_PILOT))),
        Style('own process', in_process(_PILOT), process=True),
    ],
    wrong=[
        Wrong(
            'best effort',
            changed(
                _PILOT,
                (
                    'import Node\n',
                    'import Node\nfrom rclpy.qos import qos_profile_sensor_data\n',
                ),
                ("'cmd_vel', 10", "'cmd_vel', qos_profile_sensor_data"),
            ),
            '/pilot offers best effort',
        ),
        Wrong(
            'another node name',
            changed(_PILOT, ("__init__('pilot'", "__init__('pilo'")),
            'The name is what super().__init__() gets',
        ),
        Wrong('no callback', changed(_PILOT, (_CALLBACK, '')), 'the node uses it'),
        Wrong(
            'lets nan pass',
            changed(
                _PILOT,
                (
                    "        if 0.0 <= values['speed'] <= values['limit']:\n",
                    "        if not (values['speed'] < 0.0 or values['speed'] > values['limit']):"
                    '\n',
                ),
            ),
            'A comparison with nan is always False.',
        ),
        Wrong(
            'looks at the old limit',
            changed(
                _PILOT,
                (
                    _CHECK,
                    '        values = {p.name: p.value for p in parameters}\n'
                    "        limit = self.get_parameter('limit').value\n"
                    "        if 0.0 <= values.get('speed', 0.0) <= limit:\n",
                ),
            ),
            'the node still has the old values',
        ),
        Wrong(
            'looks at the speed alone',
            changed(
                _PILOT,
                (
                    _CHECK,
                    '        values = {p.name: p.value for p in parameters}\n'
                    "        limit = values.get('limit', self.get_parameter('limit').value)\n"
                    "        if 0.0 <= values.get('speed', 0.0) <= limit:\n",
                ),
            ),
            'Some values are refused, and this one is not.',
        ),
        Wrong(
            'a fixed limit',
            changed(_PILOT, ("<= values['limit']:", '<= 0.22:')),
            'Some values are refused, and this one is not.',
        ),
        Wrong(
            'no reason',
            changed(_PILOT, (", reason='speed must be from 0.0 to limit'", '')),
            'Whoever has set the value knows now that it is wrong, and not why.',
        ),
        Wrong(
            'refuses with nothing',
            changed(
                _PILOT,
                (
                    '        return SetParametersResult('
                    "successful=False, reason='speed must be from 0.0 to limit')\n",
                    '',
                ),
            ),
            'The callback has not given back a SetParametersResult.',
        ),
        Wrong(
            'drives backwards',
            changed(_PILOT, ('if 0.0 <= values', 'if values')),
            'Some values are refused, and this one is not.',
        ),
        Wrong(
            'reads the speed once',
            changed(
                _PILOT,
                (
                    _CALLBACK,
                    f"{_CALLBACK}        self.speed = self.get_parameter('speed').value\n",
                ),
                ("msg.linear.x = self.get_parameter('speed').value", 'msg.linear.x = self.speed'),
            ),
            'The parameter has changed, and what the node does has not',
        ),
        Wrong(
            'drives at the limit',
            changed(
                _PILOT,
                (
                    "msg.linear.x = self.get_parameter('speed')",
                    "msg.linear.x = self.get_parameter('limit')",
                ),
            ),
            'That is the limit, and not the speed.',
        ),
        Wrong(
            'turns',
            changed(
                _PILOT,
                (
                    '        msg = Twist()\n',
                    '        msg = Twist()\n        msg.angular.z = 0.5\n',
                ),
            ),
            'Only linear.x is asked for.',
        ),
        Wrong(
            'no limit declared',
            changed(
                _PILOT,
                ("        self.declare('limit', 0.1, 'Greatest speed, in m/s')\n", ''),
                (_CALLBACK, ''),
            ),
            'A node has the parameters that it declares',
        ),
        Wrong(
            'keeps a value that it refuses',
            changed(
                _PILOT,
                (
                    '        values.update(',
                    '        self.speed = {p.name: p.value for p in parameters}.get('
                    "'speed', 0.0)\n"
                    '        values.update(',
                ),
                ("msg.linear.x = self.get_parameter('speed').value", 'msg.linear.x = self.speed'),
                (_CALLBACK, f'{_CALLBACK}        self.speed = 0.05\n'),
            ),
            'after it has refused',
        ),
        Wrong(
            'no description',
            changed(
                _PILOT, ('ParameterDescriptor(description=description)', 'ParameterDescriptor()')
            ),
            'a descriptor without a description',
        ),
        Wrong(
            'refuses by an error',
            changed(
                _PILOT,
                (
                    "        return SetParametersResult(successful=False, reason='speed must be "
                    "from 0.0 to limit')\n",
                    "        raise ValueError('speed must be from 0.0 to limit')\n",
                ),
            ),
            'ValueError',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'no callback, in a process of its own',
            changed(in_process(_PILOT), (_CALLBACK, '')),
            'the node uses it',
            process=True,
        ),
    ],
)
