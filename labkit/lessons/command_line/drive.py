"""Exercise: a Twist from the command line, with fields in fields."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from statistics import median
from typing import Any

from labkit.exercises import (
    Exercise,
    Fail,
    NotAttempted,
    Probe,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
)
from labkit.exercises.watch import Sample
from labkit.lessons.command_line.last_command import heard

__all__ = ['drive']

TWIST = 'geometry_msgs/msg/Twist'
TOPIC = '/cmd_vel'
COUNT = 5
PERIOD_SEC = 0.1
FORWARD, LEFT = 0.2, 0.5
EXPECTED = f'{COUNT} messages on {TOPIC} with linear.x = {FORWARD} and angular.z = {LEFT}'

_LINE = """
%ros2 topic pub --times 5 --rate 10 /cmd_vel geometry_msgs/msg/Twist \\
    "{linear: {x: 0.2}, angular: {z: 0.5}}"
"""
_ONCE = changed(_LINE, ('--times 5', '--once'))


def _judge_drive(probe: Probe) -> str:
    recorded = heard(probe, TOPIC, COUNT, EXPECTED)
    if not recorded:
        raise NotAttempted(
            f'Not attempted yet: nothing has come on {TOPIC}. Write your command in the cell '
            'above, run that cell, then run this one again.'
        )
    run = recorded.last_run()
    _expect_fields(run[-1].message)
    _expect_count(run)
    gap = median(later.stamp - earlier.stamp for earlier, later in pairwise(run))
    expect.that(
        abs(gap / PERIOD_SEC - 1.0) < 0.3,
        expected=f'a message every {PERIOD_SEC} s (10 Hz)',
        seen=f'a message every {gap:.2g} s',
        why='The option --rate says how many messages are sent in a second. Without it, it is 1.',
        todo='Use --rate 10.',
    )
    return f'{COUNT} messages came, ten a second: forwards, and to the left.'


def _expect_fields(message: Any) -> None:
    seen = {
        f'{part}.{axis}': getattr(getattr(message, part), axis)
        for part in ('linear', 'angular')
        for axis in 'xyz'
    }
    wanted = dict.fromkeys(seen, 0.0) | {'linear.x': FORWARD, 'angular.z': LEFT}
    if all(abs(seen[name] - wanted[name]) < 1e-6 for name in seen):
        return
    used = {name: value for name, value in seen.items() if value}
    why = 'linear holds the speeds in m/s, angular the turning in rad/s; x, y and z are the axes.'
    if used == {'linear.x': LEFT, 'angular.z': FORWARD}:
        why = 'The two numbers are exchanged.'
    elif used == {'linear.z': LEFT, 'angular.x': FORWARD} or 'angular.x' in used:
        why = 'linear and angular are exchanged: linear is for driving, angular for turning.'
    elif used.get('angular.z', 0.0) < 0.0:
        why = 'A turn to the left is positive, to the right negative.'
    elif used.get('angular.z', 0.0) > 6.0:
        why = 'Angles are in radians: 0.5 rad is about 29 degrees.'
    elif 'angular.y' in used or 'linear.z' in used:
        why = 'x points forwards, y to the left, z upwards. A robot on the ground turns about z.'
    raise Fail(
        f'linear.x = {FORWARD} and angular.z = {LEFT}, all else 0',
        ', '.join(f'{name} = {value:g}' for name, value in used.items()) or 'all fields are 0',
        why=why,
        todo='Write {linear: {x: ...}, angular: {z: ...}}.',
    )


def _expect_count(run: Sequence[Sample]) -> None:
    why = 'Without --times or --once a command goes on until it is stopped.'
    if len(run) < COUNT:
        why = '--once sends one message. --times says how many are to be sent.'
    expect.that(
        len(run) == COUNT,
        expected=f'{COUNT} messages on {TOPIC}',
        seen=f'{len(run)} of them',
        why=why,
        todo=f'Use --times {COUNT}.',
    )


drive = Exercise(
    name='drive',
    task=f'Publish {COUNT} messages on {TOPIC} as `{TWIST}`, ten a second: {FORWARD} m/s '
    f'forwards and {LEFT} rad/s to the left.',
    publishes={TOPIC: TWIST},
    shared=[TOPIC],
    judge=_judge_drive,
    hints=[
        'interface show lists the fields of a Twist, and interface proto a message to copy.',
        'linear and angular are messages themselves, so each gets braces of its own: '
        '{linear: {x: ...}, angular: {z: ...}}',
        f'The options are --times {COUNT} and --rate 10.',
    ],
    answer=Solution(
        _LINE,
        'Fields that are not named stay 0. Inner braces hold the fields of an inner message. '
        '--times is how many messages are sent, --rate is how many in a second.',
    ),
    styles=[
        Style(
            'in lines, all fields',
            """
%ros2 topic pub -r 10 -t 5 cmd_vel geometry_msgs/msg/Twist \\
    "{linear: {x: 0.2, y: 0, z: 0.0}, angular: {x: 0.0, y: 0.0, z: 5.0e-1}}"
""",
        ),
        Style(
            'a node',
            """
import rclpy
from geometry_msgs.msg import Twist

node = lab.spin(rclpy.create_node('driver'))
publisher = node.create_publisher(Twist, '/cmd_vel', 10)
twist = Twist()
twist.linear.x, twist.angular.z = 0.2, 0.5
rate = node.create_rate(10)
for _ in range(5):
    publisher.publish(twist)
    rate.sleep()
""",
        ),
    ],
    wrong=[
        Wrong(
            'fields without their message',
            changed(_LINE, ('linear: {x: 0.2}, angular: {z: 0.5}', 'x: 0.2, z: 0.5')),
            'Fields that are messages themselves take braces of their own.',
        ),
        Wrong(
            'numbers exchanged',
            changed(_ONCE, ('x: 0.2}', 'x: 0.5}'), ('z: 0.5}', 'z: 0.2}')),
            'The two numbers are exchanged.',
        ),
        Wrong(
            'messages exchanged',
            changed(_ONCE, ('linear', 'l'), ('angular', 'linear'), ('l:', 'angular:')),
            'linear and angular are exchanged',
        ),
        Wrong('to the right', changed(_ONCE, ('z: 0.5', 'z: -0.5')), 'A turn to the left is'),
        Wrong('degrees', changed(_ONCE, ('z: 0.5', 'z: 28.6')), 'Angles are in radians'),
        Wrong('wrong axis', changed(_ONCE, ('z: 0.5', 'y: 0.5')), 'turns about z'),
        Wrong('one message', _ONCE, '--once sends one message.'),
        Wrong(
            'without an end',
            changed(_LINE, ('--times 5', '--timeout 0.65')),
            'goes on until it is stopped',
        ),
        Wrong('too slow', changed(_LINE, ('--rate 10', '--rate 5')), 'Without it, it is 1.'),
        Wrong('other topic', changed(_ONCE, ('/cmd_vel', '/cmdvel -w 0')), 'is not /cmd_vel'),
    ],
    records=[TOPIC],
)
