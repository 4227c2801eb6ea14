"""Answers to `pilot`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

RUN = 'python3 nodes/pilot.py > pilot.log 2>&1 &\n'

ANSWERS = [
    wrong('in the notebook', 'A node of a notebook ends with the notebook.'),
    wrong('not started', 'No program of that name runs on this machine', (RUN, '')),
    wrong(
        'without the line with export',
        'it has none: domain 0',
        (RUN, f'env -u ROS_DOMAIN_ID {RUN}'),
    ),
    wrong(
        'changed while it runs',
        'A program keeps the code with which it was started.',
        (RUN, f'{RUN}touch -d "5 seconds" nodes/pilot.py\n'),
    ),
    wrong(
        'another node name',
        'The name of the node is what super().__init__() gets.',
        ("__init__('pilot'", "__init__('pilots'"),
    ),
    wrong('another file', 'the file nodes/pilots.py', ('> nodes/pilot.py', '> nodes/pilots.py')),
    wrong(
        'best effort',
        '/pilot offers best effort',
        ('import Node\n', 'import Node\nfrom rclpy.qos import qos_profile_sensor_data\n'),
        ("'cmd_vel', 10", "'cmd_vel', qos_profile_sensor_data"),
    ),
    wrong(
        'no callback',
        'the node uses it',
        ('        self.add_on_set_parameters_callback(self.on_set)\n', ''),
    ),
    wrong(
        'lets nan pass',
        'A comparison with nan is always False.',
        (
            "        if 0.0 <= values['speed'] <= values['limit']:\n",
            "        if not (values['speed'] < 0.0 or values['speed'] > values['limit']):\n",
        ),
    ),
    wrong(
        'looks at the old limit',
        'the node still has the old values',
        (
            '        values = {name: self.get_parameter(name).value for name in '
            "('speed', 'limit')}\n"
            '        values.update({p.name: p.value for p in parameters if p.name '
            "in values})\n        if 0.0 <= values['speed'] <= values['limit']:\n",
            '        values = {p.name: p.value for p in parameters}\n'
            "        limit = self.get_parameter('limit').value\n"
            "        if 0.0 <= values.get('speed', 0.0) <= limit:\n",
        ),
    ),
    wrong(
        'looks at the speed alone',
        'Some values are refused, and this one is not.',
        (
            '        values = {name: self.get_parameter(name).value for name in '
            "('speed', 'limit')}\n"
            '        values.update({p.name: p.value for p in parameters if p.name '
            "in values})\n        if 0.0 <= values['speed'] <= values['limit']:\n",
            '        values = {p.name: p.value for p in parameters}\n'
            "        limit = values.get('limit', self.get_parameter('limit').value)\n"
            "        if 0.0 <= values.get('speed', 0.0) <= limit:\n",
        ),
    ),
    wrong(
        'a fixed limit',
        'These values are allowed',
        ("<= values['limit']:", '<= 0.22:'),
    ),
    wrong(
        'a limit that is never over 0.3',
        'These values are allowed',
        (
            "0.0 <= values['speed'] <= values['limit']:",
            "0 <= values['speed'] <= values['limit'] <= 0.3:",
        ),
    ),
    wrong(
        'never faster than 0.3',
        'all else 0.0, in each message',
        (
            "msg.linear.x = self.get_parameter('speed').value",
            "msg.linear.x = min(self.get_parameter('speed').value, 0.3)",
        ),
    ),
    wrong(
        'the limit itself is refused',
        'These values are allowed',
        ("<= values['limit']:", "< values['limit']:"),
    ),
    wrong(
        'standing still is refused',
        'These values are allowed',
        ("if 0.0 <= values['speed']", "if 0.0 < values['speed']"),
    ),
    wrong(
        'no reason',
        'The caller learns that the value was refused, but not why.',
        (", reason='speed must be from 0.0 to limit'", ''),
    ),
    wrong(
        'refuses with nothing',
        'has not given back a SetParametersResult.',
        (
            "        return SetParametersResult(successful=False, reason='speed "
            "must be from 0.0 to limit')\n",
            '',
        ),
    ),
    wrong(
        'drives backwards',
        'Some values are refused, and this one is not.',
        ('if 0.0 <= values', 'if values'),
    ),
    wrong(
        'reads the speed once',
        'The parameter has changed, and what the node does has not',
        (
            '        self.add_on_set_parameters_callback(self.on_set)\n',
            '        self.add_on_set_parameters_callback(self.on_set)\n'
            "        self.speed = self.get_parameter('speed').value\n",
        ),
        ("msg.linear.x = self.get_parameter('speed').value", 'msg.linear.x = self.speed'),
    ),
    wrong(
        'five changes and no more',
        'The parameter has changed, and what the node does has not',
        (
            '    def on_change(self, parameters):\n',
            '    def on_change(self, parameters):\n'
            "        self.changes = getattr(self, 'changes', 0) + 1\n"
            '        if self.changes > 5:\n            return\n',
        ),
        of='keeps the speed in an attribute',
    ),
    wrong(
        'no limit declared',
        'A node has the parameters that it declares',
        ("        self.declare('limit', 0.1, 'Greatest speed, in m/s')\n", ''),
        ('        self.add_on_set_parameters_callback(self.on_set)\n', ''),
    ),
    wrong(
        'keeps a value that it refuses',
        'all else 0.0, in each message',
        (
            '        values.update(',
            '        self.speed = {p.name: p.value for p in '
            "parameters}.get('speed', 0.0)\n        values.update(",
        ),
        ("msg.linear.x = self.get_parameter('speed').value", 'msg.linear.x = self.speed'),
        (
            '        self.add_on_set_parameters_callback(self.on_set)\n',
            '        self.add_on_set_parameters_callback(self.on_set)\n'
            '        self.speed = 0.05\n',
        ),
    ),
    wrong(
        'no description',
        'a descriptor without a description',
        ('ParameterDescriptor(description=description)', 'ParameterDescriptor()'),
    ),
    wrong(
        'refuses by an error',
        'If it ends at once, read there why.',
        (
            "        return SetParametersResult(successful=False, reason='speed "
            "must be from 0.0 to limit')\n",
            "        raise ValueError('speed must be from 0.0 to limit')\n",
        ),
    ),
    wrong(
        'another topic',
        'names must be equal to the last letter',
        ("'cmd_vel'", "'cmd_velo'"),
    ),
    right(
        'keeps the speed in an attribute',
        (
            '        self.add_on_set_parameters_callback(self.on_set)\n',
            '        self.add_on_set_parameters_callback(self.on_set)\n'
            '        self.add_post_set_parameters_callback(self.on_change)\n'
            '        self.speed = 0.05\n',
        ),
        (
            '    def on_timer',
            '    def on_change(self, parameters):\n'
            "        self.speed = self.get_parameter('speed').value\n\n    def on_timer",
        ),
        ("msg.linear.x = self.get_parameter('speed').value", 'msg.linear.x = self.speed'),
    ),
    right(
        'asks what is forbidden, and for nan',
        (
            "        if 0.0 <= values['speed'] <= values['limit']:\n",
            "        speed, limit = values['speed'], values['limit']\n"
            '        bad = math.isnan(speed) or math.isnan(limit)\n'
            '        if not (bad or speed < 0.0 or speed > limit):\n',
        ),
        ('import rclpy\n', 'import math\n\nimport rclpy\n'),
    ),
    right(
        'a range for the lower end, besides',
        (
            '        self.declare_parameter(name, value, '
            'ParameterDescriptor(description=description))\n',
            '        positive = FloatingPointRange(from_value=0.0, to_value=1000.0)\n'
            '        descriptor = ParameterDescriptor(description=description, '
            'floating_point_range=[positive])\n'
            '        self.declare_parameter(name, value, descriptor)\n',
        ),
        (
            'import ParameterDescriptor, SetParametersResult\n',
            'import FloatingPointRange, ParameterDescriptor, SetParametersResult\n',
        ),
    ),
    right(
        'with values from its command line',
        (RUN, RUN.replace('pilot.py', 'pilot.py --ros-args -p limit:=0.22')),
    ),
]
