"""Answers to `ending`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'all are required',
        'stays dead, unless its node says respawn',
        ('respawn="true"', 'on_exit="shutdown"'),
    ),
    wrong(
        'the driver comes again',
        'since its node says respawn',
        ('on_exit="shutdown"', 'respawn="true"'),
    ),
    wrong(
        'two times',
        'and no more',
        ('respawn="true"', 'respawn="true" respawn_max_retries="2"'),
    ),
    wrong(
        'five times',
        'and no more',
        ('respawn="true"', 'respawn="true" respawn_max_retries="5"'),
    ),
    wrong(
        'five times, in Python',
        'and no more',
        ('respawn=True', 'respawn=True, respawn_max_retries=5'),
        of='in Python',
    ),
    wrong(
        'attribute misspelt',
        'ending.launch.xml, line 5',
        ('respawn="true"', 'respwan="true"'),
    ),
    wrong(
        'a word that is neither true nor false',
        'ending.launch.xml, line 5',
        ('respawn="true"', 'respawn="always"'),
    ),
    wrong(
        'no namespace',
        'The name is right, and the namespace is not.',
        ('    <push_ros_namespace namespace="robot1"/>\n', ''),
    ),
    wrong(
        'no listener',
        'the node /robot1/listener',
        ('    <node pkg="demo_nodes_py" exec="listener"/>\n', ''),
    ),
    wrong(
        'one more',
        'The file starts more than the task asks for.',
        (
            'exec="listener"/>\n',
            'exec="listener"/>\n    <node pkg="demo_nodes_py" exec="talker" name="b"/>\n',
        ),
    ),
    wrong(
        'one more, later',
        'a timer that starts something 60 s later',
        (
            '  </group>\n',
            '    <timer period="60.0">\n      <node pkg="demo_nodes_py" exec="talker" name="b"/>\n'
            '    </timer>\n  </group>\n',
        ),
    ),
    right(
        'a pause before it comes again', ('respawn="true"', 'respawn="true" respawn_delay="0.2"')
    ),
    right(
        'no group',
        ('    <push_ros_namespace namespace="robot1"/>\n', ''),
        ('<node ', '<node namespace="robot1" '),
    ),
    right('in YAML'),
    right('in Python'),
]
