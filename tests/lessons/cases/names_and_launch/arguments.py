"""Answers to `arguments`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'the namespace is fixed',
        'namespace="$(var robot)" in the node',
        ('"$(var robot)"', '"robot1"'),
    ),
    wrong('a default is missing', 'arguments.launch.xml, line 2', (' default="robot1"', '')),
    wrong('another default', 'Seen: /robot/driver', ('default="robot1"', 'default="robot"')),
    wrong(
        'the speed is fixed',
        'That is the value of its declaration',
        ('value="$(var speed)"', 'value="0.1"'),
    ),
    wrong(
        'another default of the speed',
        'The file gives it another value.',
        ('default="0.1"', 'default="0.15"'),
    ),
    wrong(
        'another name of an argument',
        'That is the value of its declaration',
        ('<arg name="speed"', '<arg name="velocity"'),
        ('$(var speed)', '$(var velocity)'),
    ),
    wrong(
        'a condition the wrong way', 'nothing asks the argument', ('if="$(var', 'unless="$(var')
    ),
    wrong('an argument misspelt', 'arguments.launch.xml, line', ('$(var talk)', '$(var tallk)')),
    wrong(
        'the talker is outside',
        'namespace="$(var robot)"',
        (
            '    <node pkg="demo_nodes_py" exec="talker" if="$(var talk)"/>\n  </group>\n',
            '  </group>\n  <node pkg="demo_nodes_py" exec="talker" if="$(var talk)"/>\n',
        ),
    ),
    wrong(
        'a listener, too',
        'The file starts more than the task asks for.',
        ('  </group>', '    <node pkg="demo_nodes_py" exec="listener"/>\n  </group>'),
    ),
    wrong('a speed that is no number', 'InvalidParameterTypeException', ('"0.1"', '"slow"')),
    wrong(
        'a talker for other robots',
        'it is not there',
        (
            '$(var talk)',
            '$(and $(var talk) $(not $(equals $(var robot) robot1)))',
        ),
    ),
    wrong(
        'a driver that comes in an hour',
        'a timer that starts something 3600 s later',
        (
            '    <node pkg="robots_lab" exec="driver">',
            '    <timer period="3600.0">\n    <node pkg="robots_lab" exec="driver">',
        ),
        ('    </node>\n', '    </node>\n    </timer>\n'),
    ),
    wrong(
        'a talker that comes in an hour',
        'a timer that starts something 3600 s later',
        (
            '    <node pkg="demo_nodes_py" exec="talker" if="$(var talk)"/>\n',
            '    <timer period="3600.0">\n'
            '      <node pkg="demo_nodes_py" exec="talker" if="$(var talk)"/>\n    </timer>\n',
        ),
    ),
    wrong(
        'the condition is at the group',
        'an if= or unless= keeps it away',
        ('  <group>', '  <group if="$(var talk)">'),
    ),
    wrong(
        'at most 0.11',
        'The file gives it another value.',
        ('value="$(var speed)"', 'value="$(eval \'min(0.11, $(var speed))\')"'),
    ),
    wrong('the robots of the lesson alone', 'The name is right, and the namespace is not.'),
    right(
        'no group',
        ('    <push_ros_namespace namespace="$(var robot)"/>\n', ''),
        ('exec="driver"', 'exec="driver" namespace="$(var robot)"'),
        ('exec="talker"', 'exec="talker" namespace="$(var robot)"'),
    ),
    right(
        'a condition around it',
        (
            '    <node pkg="demo_nodes_py" exec="talker" if="$(var talk)"/>\n',
            '    <group unless="$(not $(var talk))">\n'
            '      <node pkg="demo_nodes_py" exec="talker"/>\n    </group>\n',
        ),
    ),
    right('in YAML'),
    right('in Python'),
]
