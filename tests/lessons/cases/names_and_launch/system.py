"""Answers to `system`, and what the check says to each."""

from __future__ import annotations

from cases import NOT_ATTEMPTED, right, wrong

__all__ = ['ANSWERS']

DRIVER = """\
  <node pkg="robots_lab" exec="driver" namespace="robot1">
    <param name="speed" value="0.15"/>
  </node>
"""

ANSWERS = [
    wrong('a tag is misspelt', "Did you mean 'param'?", ('<param ', '<parm ')),
    wrong('not XML', 'system.launch.xml, line 10', ('  </node>\n</launch>', '</launch>')),
    wrong('no such program', "Did you mean 'talker'?", ('exec="talker"', 'exec="talk"')),
    wrong(
        'no such argument', 'system.launch.xml, line 8', ('value="0.15"', 'value="$(var speed)"')
    ),
    wrong(
        'absolute to',
        'A name that begins with / is absolute: no namespace is put before it.',
        ('to="news"', 'to="/news"'),
    ),
    wrong(
        'absolute from',
        'the remap from /chatter matches nothing',
        ('from="chatter"', 'from="/chatter"'),
    ),
    wrong(
        'name of the code',
        'Without name="..." a node has the name of its code.',
        (' name="speaker"', ''),
    ),
    wrong(
        'no namespace',
        'The name is right, and the namespace is not.',
        ('name="speaker" namespace="tower"', 'name="speaker"'),
    ),
    wrong(
        'remap of the speaker alone',
        'the node was given no remap',
        (
            '"listener" namespace="tower">\n    <remap from="chatter" to="news"/>\n  </node>',
            '"listener" namespace="tower"/>',
        ),
    ),
    wrong('another topic', 'The topic has another name.', ('to="news"', 'to="new"')),
    wrong(
        'parameter misspelt',
        'That is the value of its declaration',
        ('name="speed"', 'name="sped"'),
    ),
    wrong('another value', 'The file gives it another value.', ('"0.15"', '"0.51"')),
    wrong(
        'a turn, too',
        'The file gives it another value.',
        ('value="0.15"/>', 'value="0.15"/><param name="turn" value="0.0"/>'),
    ),
    wrong('a text for a number', 'InvalidParameterTypeException', ('"0.15"', '"fast"')),
    wrong(
        'one node too many',
        'The file starts more than the task asks for.',
        ('</launch>', '  <node pkg="demo_nodes_py" exec="talker"/>\n</launch>'),
    ),
    wrong(
        'one twice',
        'Take one of them out.',
        ('</launch>', f'{DRIVER}</launch>'),
    ),
    wrong('no driver', 'The file starts no node of such a name.', (DRIVER, '')),
    wrong(
        'a capital letter in the name',
        '/tower/Speaker is not /tower/speaker',
        ('name="speaker"', 'name="Speaker"'),
    ),
    wrong(
        'the listener for the speaker',
        'it is another program than the one that is meant',
        ('exec="talker"', 'exec="listener"'),
    ),
    wrong(
        'in a folder beside',
        'Write your code in the cell above',
        ('%%writefile system', '%%writefile src/system'),
        outcome=NOT_ATTEMPTED,
    ),
    wrong(
        'a listener that comes late',
        'a timer that starts something 5 s later',
        (
            '</launch>',
            '  <timer period="5.0">\n    <node pkg="demo_nodes_py" exec="listener"/>\n'
            '  </timer>\n</launch>',
        ),
    ),
    wrong(
        'a driver that comes in an hour',
        'a timer that starts something 3600 s later',
        (DRIVER, f'  <timer period="3600.0">\n{DRIVER}  </timer>\n'),
    ),
    wrong(
        'a program that is no node',
        'The file starts more than the task asks for.',
        ('</launch>', '  <executable cmd="sleep 100"/>\n</launch>'),
    ),
    right(
        'a driver that comes a little later',
        (DRIVER, f'  <timer period="0.5">\n{DRIVER}  </timer>\n'),
    ),
    right(
        'groups',
        (' namespace="tower"', ''),
        ('    <remap from="chatter" to="news"/>\n', ''),
        (
            '<launch>\n',
            '<launch>\n  <group>\n    <push_ros_namespace namespace="tower"/>\n'
            '    <set_remap from="chatter" to="news"/>\n',
        ),
        ('  <node pkg="robots_lab"', '  </group>\n  <node pkg="robots_lab"'),
    ),
    right(
        'whole names',
        ('from="chatter" to="news"', 'from="/tower/chatter" to="/tower/news"'),
    ),
    right(
        'words for ROS',
        (
            'name="speaker" namespace="tower"',
            'ros_args="-r __node:=speaker -r __ns:=/tower"',
        ),
    ),
    right('in YAML'),
    right('in Python'),
]
