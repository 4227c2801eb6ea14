"""Answers to `hearing`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

TO_1 = '<remap from="chatter" to="/robot1/chatter"/>'
TO_2 = '<remap from="chatter" to="/robot2/chatter"/>'

ANSWERS = [
    wrong(
        'to the own topic',
        'The remap leads to the topic of its own robot',
        (TO_2, '<remap from="chatter" to="/robot1/chatter"/>'),
    ),
    wrong(
        'both talkers are remapped, too',
        'Remap the listeners only.',
        (
            'namespace="robot1"/>\n    <node pkg="demo_nodes_py" exec="talker"/>',
            'namespace="robot1"/>\n    <node pkg="demo_nodes_py" exec="talker">\n'
            f'      {TO_2}\n    </node>',
        ),
        (
            'namespace="robot2"/>\n    <node pkg="demo_nodes_py" exec="talker"/>',
            'namespace="robot2"/>\n    <node pkg="demo_nodes_py" exec="talker">\n'
            f'      {TO_1}\n    </node>',
        ),
    ),
    wrong(
        'one namespace is gone',
        'The name is right, and the namespace is not.',
        ('    <push_ros_namespace namespace="robot2"/>\n', ''),
    ),
    wrong(
        'one listener is gone',
        'the node /robot2/listener',
        (
            f'    <node pkg="demo_nodes_py" exec="listener">\n      {TO_1}\n    </node>\n',
            '',
        ),
    ),
    wrong(
        'another name',
        'Without name="..." a node has the name of its code.',
        (
            f'exec="listener">\n      {TO_1}',
            f'exec="listener" name="ear">\n      {TO_1}',
        ),
    ),
    wrong(
        'a relay',
        'The file starts more than the task asks for.',
        ('</launch>', '  <node pkg="demo_nodes_py" exec="talker"/>\n</launch>'),
    ),
    wrong('a tag is misspelt', "Did you mean 'remap'?", ('<remap ', '<remapp ')),
    wrong(
        'a remap for both, in the group',
        'everybody hears everybody',
        (f'      {TO_1}\n', ''),
        (f'      {TO_2}\n', ''),
        (
            'namespace="robot1"/>\n',
            'namespace="robot1"/>\n    <set_remap from="chatter" to="/robot2/chatter"/>\n',
        ),
    ),
    right(
        'the talkers are remapped',
        (f'exec="listener">\n      {TO_1}\n    </node>', 'exec="listener"/>'),
        (f'exec="listener">\n      {TO_2}\n    </node>', 'exec="listener"/>'),
        (
            'namespace="robot1"/>\n    <node pkg="demo_nodes_py" exec="talker"/>',
            'namespace="robot1"/>\n    <node pkg="demo_nodes_py" exec="talker">\n'
            f'      {TO_2}\n    </node>',
        ),
        (
            'namespace="robot2"/>\n    <node pkg="demo_nodes_py" exec="talker"/>',
            'namespace="robot2"/>\n    <node pkg="demo_nodes_py" exec="talker">\n'
            f'      {TO_1}\n    </node>',
        ),
    ),
    right(
        'whole names',
        (TO_1, '<remap from="/robot2/chatter" to="/robot1/chatter"/>'),
        (TO_2, '<remap from="/robot1/chatter" to="/robot2/chatter"/>'),
    ),
    right(
        'words for ROS',
        (
            f'exec="listener">\n      {TO_1}',
            'exec="listener" ros_args="-r chatter:=/robot1/chatter">',
        ),
    ),
    right('in YAML'),
    right('in Python'),
]
