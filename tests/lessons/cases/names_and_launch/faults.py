"""Answers to `faults`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

TALKER = """\
    <node pkg="demo_nodes_py" exec="talker">
      <remap from="chatter" to="news"/>
    </node>
"""

ANSWERS = [
    wrong('the argument is left', 'faults.launch.xml, line 5', ('$(var robot)', '$(var name)')),
    wrong('the program is left', "Did you mean 'driver'?", ('exec="driver"', 'exec="drive"')),
    wrong('the tag is left', "Did you mean 'remap'?", ('<remap ', '<remapp ')),
    wrong(
        'the parameter is left',
        'That is the value of its declaration',
        ('name="speed"', 'name="sped"'),
    ),
    wrong(
        'the topic is left',
        'the remap from chater matches nothing',
        ('from="chatter"', 'from="chater"'),
    ),
    wrong(
        'the argument is another one',
        'Seen: /robot1/driver',
        ('default="amy"', 'default="robot1"'),
    ),
    wrong('the argument has no value', 'faults.launch.xml, line 3', (' default="amy"', '')),
    wrong(
        'the remap is gone',
        'the node was given no remap',
        ('      <remap from="chatter" to="news"/>\n', ''),
    ),
    wrong('the talker is gone', 'The file starts no node of such a name.', (TALKER, '')),
    wrong('the turn of the code', 'as if the file gave it none', ('"-0.5"', '"0.5"')),
    wrong('the turn is turned', 'The file gives it another value.', ('"-0.5"', '"0.6"')),
    wrong(
        'one more',
        'The file starts more than the task asks for.',
        ('  </group>', '    <node pkg="demo_nodes_py" exec="listener"/>\n  </group>'),
    ),
    right(
        'another name of the argument',
        ('<arg name="robot"', '<arg name="name"'),
        ('$(var robot)', '$(var name)'),
    ),
    right(
        'no argument',
        ('  <arg name="robot" default="amy"/>\n', ''),
        ('$(var robot)', 'amy'),
    ),
    right(
        'set for the group',
        ('      <param name="speed" value="0.2"/>\n', ''),
        (
            '"$(var robot)"/>\n',
            '"$(var robot)"/>\n    <set_parameter name="speed" value="0.2"/>\n',
        ),
    ),
    right('whole names', ('from="chatter" to="news"', 'from="/amy/chatter" to="/amy/news"')),
    right('in Python'),
]
