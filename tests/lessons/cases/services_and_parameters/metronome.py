"""Answers to `metronome`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong('begins with another rate', 'with rate = 2.0', ('start_timer(2.0)', 'start_timer(4.0)')),
    wrong(
        'reacts before it is decided',
        'The node has refused a value, and uses it all the same.',
        ('add_post_set', 'add_pre_set'),
        (
            '                self.destroy_timer(self.timer)\n'
            '                self.start_timer(parameter.value)\n',
            '                value = parameter.value\n'
            '                if isinstance(value, float) and 0.0 < value < 50.0:\n'
            '                    self.destroy_timer(self.timer)\n'
            '                    self.start_timer(value)\n        return parameters\n',
        ),
    ),
    wrong(
        'no reaction',
        'The parameter has changed, and what the node does has not',
        ('        self.add_post_set_parameters_callback(self.on_change)\n', ''),
    ),
    wrong(
        'five changes and no more',
        'a message every',
        (
            '        for parameter in parameters:\n',
            "        self.changes = getattr(self, 'changes', 0) + 1\n"
            '        for parameter in parameters if self.changes <= 5 else ():\n',
        ),
    ),
    wrong(
        'no range',
        'A range in the descriptor is checked by ROS itself',
        (
            '            floating_point_range=[FloatingPointRange(from_value=1.0, '
            'to_value=20.0)],\n',
            '',
        ),
    ),
    wrong('another range', 'a range from 1.0 to 10.0', ('to_value=20.0', 'to_value=10.0')),
    wrong(
        'no description',
        'a descriptor without a description',
        ("            description='Ticks a second, in Hz',\n", ''),
    ),
    wrong(
        'an integer',
        '2 is an integer, 2.0 a double',
        ("'rate', 2.0", "'rate', 2"),
        (
            '            floating_point_range=[FloatingPointRange(from_value=1.0, '
            'to_value=20.0)],\n',
            '            integer_range=[IntegerRange(from_value=1, to_value=20)],\n',
        ),
        ('FloatingPointRange,', 'IntegerRange,'),
    ),
    wrong(
        'any type',
        'dynamic_typing is on',
        (
            '            floating_point_range=[FloatingPointRange(from_value=1.0, '
            'to_value=20.0)],\n',
            '            floating_point_range=[FloatingPointRange(from_value=1.0, '
            'to_value=20.0)],\n            dynamic_typing=True,\n',
        ),
    ),
    wrong('another name', 'rates is not rate', ("'rate'", "'rates'")),
    wrong(
        'not declared',
        'A node has the parameters that it declares',
        ("self.declare_parameter('rate', 2.0, descriptor)", 'self.about = descriptor'),
    ),
    wrong(
        'rate for period',
        'A rate in Hz and a period in seconds were mixed up',
        ('create_timer(1.0 / rate,', 'create_timer(rate,'),
    ),
    wrong(
        'the old timer goes on',
        'times too fast',
        ('                self.destroy_timer(self.timer)\n', ''),
    ),
    wrong(
        'refuses what is allowed',
        'a node that refuses them cannot be used',
        (
            '        self.add_post_set_parameters_callback(self.on_change)\n',
            '        self.add_post_set_parameters_callback(self.on_change)\n'
            '        self.add_on_set_parameters_callback(self.on_set)\n',
        ),
        (
            '    def on_timer',
            '    def on_set(self, parameters):\n'
            "        return SetParametersResult(successful=False, reason='no')\n\n"
            '    def on_timer',
        ),
        ('ParameterDescriptor\n', 'ParameterDescriptor, SetParametersResult\n'),
    ),
    wrong(
        'asked, and says nothing',
        'return SetParametersResult(...)',
        (
            '        self.add_post_set_parameters_callback(self.on_change)\n',
            '        self.add_post_set_parameters_callback(self.on_change)\n'
            '        self.add_on_set_parameters_callback(self.on_set)\n',
        ),
        ('    def on_timer', '    def on_set(self, parameters): ...\n\n    def on_timer'),
    ),
    wrong(
        'a burst at each change',
        'They come in bursts',
        (
            '                self.start_timer(parameter.value)\n',
            '                self.start_timer(parameter.value)\n'
            '                for _ in range(3):\n                    self.on_timer()\n',
        ),
    ),
    wrong(
        'a burst at each change, in a process of its own',
        'They come in bursts',
        of='a burst at each change',
        run='process',
    ),
    wrong('not spun', 'Hand the node over: lab.spin(node)'),
    wrong(
        'no reaction, in a process of its own',
        'The parameter has changed, and what the node does has not',
        ('        self.add_post_set_parameters_callback(self.on_change)\n', ''),
        run='process',
    ),
    right(
        'another period for the same timer',
        (
            '                self.destroy_timer(self.timer)\n'
            '                self.start_timer(parameter.value)\n',
            '                self.timer.timer_period_ns = int(1e9 / parameter.value)\n',
        ),
    ),
    right(
        'begins anew with a tick at each change',
        (
            '                self.start_timer(parameter.value)\n',
            '                self.start_timer(parameter.value)\n                self.on_timer()\n',
        ),
    ),
    right(
        'looks at each tick',
        ('        self.add_post_set_parameters_callback(self.on_change)\n', ''),
        (
            '        self.publisher.publish(Empty())\n',
            '        self.publisher.publish(Empty())\n'
            "        period = int(1e9 / self.get_parameter('rate').value)\n"
            '        if self.timer.timer_period_ns != period:\n'
            '            self.timer.timer_period_ns = period\n'
            '            self.timer.reset()\n',
        ),
    ),
    right(
        'a callback that only looks, besides',
        (
            '        self.add_post_set_parameters_callback(self.on_change)\n',
            '        self.add_post_set_parameters_callback(self.on_change)\n'
            '        self.add_on_set_parameters_callback(self.on_set)\n',
        ),
        (
            '    def on_timer',
            '    def on_set(self, parameters):\n'
            '        good = all(p.value is not None for p in parameters)\n'
            "        return SetParametersResult(successful=good, reason='no value')\n\n"
            '    def on_timer',
        ),
        ('ParameterDescriptor\n', 'ParameterDescriptor, SetParametersResult\n'),
    ),
]
