"""Exercise: a Twist from the command line, with fields in fields."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
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
from labkit.lessons.command_line.last_command import commanded_rate
from labkit.lessons.command_line.sent import (
    Asked,
    OnTopic,
    Sent,
    is_every,
    judge_sent,
    messages_at_once,
    newest_run,
    period,
)

__all__ = ['drive']

TWIST = 'geometry_msgs/msg/Twist'
TOPIC = '/cmd_vel'
COUNT = 5
PERIOD_SEC = 0.1
# So many times the period is too slow, whatever comes next.
SLOW = 4
FORWARD, LEFT = 0.2, 0.5
EXPECTED = f'{COUNT} messages on {TOPIC} with linear.x = {FORWARD} and angular.z = {LEFT}'

_LINE = """
%ros2 topic pub --times 5 --rate 10 /cmd_vel geometry_msgs/msg/Twist \\
    "{linear: {x: 0.2}, angular: {z: 0.5}}"
"""
_ONCE = changed(_LINE, ('--times 5', '--once'))


def _judge_drive(probe: Probe) -> str:
    judge_sent(
        probe,
        _WHERE,
        _CLAUSES,
        EXPECTED,
        is_whole=_is_whole,
        is_too_much=_is_too_much,
        keep=lambda sent: sent.samples,
    )
    return f'{COUNT} messages came, ten a second: forwards, and to the left.'


def _is_whole(samples: Sequence[Sample]) -> bool:
    return bool(samples) and len(newest_run(samples)) == COUNT


def _is_too_much(samples: Sequence[Sample]) -> bool:
    """Tell whether it is clear that these are too many messages, or too slow ones."""
    run = newest_run(samples)
    return len(run) > COUNT or _is_slow(run)


def _is_slow(run: Sequence[Sample]) -> bool:
    # A busy machine delays messages, but not to several times their period.
    return len(run) > 2 and period(run) > SLOW * PERIOD_SEC


def _expect_fields(sent: Sent) -> None:
    for sample in newest_run(sent.samples):
        _expect_twist(sample.message)


def _expect_twist(message: Any) -> None:
    seen = {
        f'{part}.{axis}': getattr(getattr(message, part), axis)
        for part in ('linear', 'angular')
        for axis in 'xyz'
    }
    wanted = dict.fromkeys(seen, 0.0) | {'linear.x': FORWARD, 'angular.z': LEFT}
    if all(abs(seen[name] - wanted[name]) < 1e-6 for name in seen):
        return
    used = {name: value for name, value in seen.items() if value}
    raise Fail(
        f'linear.x = {FORWARD} and angular.z = {LEFT}, all else 0, in every message',
        ', '.join(f'{name} = {value:g}' for name, value in used.items()) or 'all fields are 0',
        why=_misconception(used),
        todo='Write {linear: {x: ...}, angular: {z: ...}}.',
    )


def _misconception(used: Mapping[str, float]) -> str:
    """Return what leads to the fields that are not 0."""
    if not all(map(math.isfinite, used.values())):
        return 'A speed is a number. nan is none, and no robot can drive at inf.'
    if used == {'linear.x': LEFT, 'angular.z': FORWARD}:
        return 'The two numbers are exchanged.'
    if used == {'linear.z': LEFT, 'angular.x': FORWARD} or 'angular.x' in used:
        return 'linear and angular are exchanged: linear is for driving, angular for turning.'
    if used.get('angular.z', 0.0) < 0.0:
        return 'A turn to the left is positive, to the right negative.'
    if used.get('angular.z', 0.0) > 6.0:
        return 'Angles are in radians: 0.5 rad is about 29 degrees.'
    if 'angular.y' in used or 'linear.z' in used:
        return 'x points forwards, y to the left, z upwards. A robot on the ground turns about z.'
    return (
        'linear holds the speeds in m/s, angular the turning in rad/s; x, y and z are the axes. '
        'Fields that are not named stay 0.'
    )


def _expect_count(sent: Sent) -> None:
    samples, run = sent.samples, newest_run(sent.samples)
    if sent.is_running and _is_slow(run):
        return  # the rate says so at once
    if sent.is_running and not _is_whole(run) and not _is_too_much(run):
        raise NotAttempted(
            f'{len(run)} of {COUNT} messages have come on {TOPIC}, and the command still runs. '
            'Run this cell again when it has ended.'
        )
    first, last = run[0].number, run[-1].number
    # A message that was lost on its way was sent all the same.
    count, others = last - first + 1, messages_at_once(samples, run)
    why = 'Without --times or --once a command goes on until it is stopped.'
    todo = f'Use --times {COUNT}.'
    seen = f'{count} of them'
    if others:
        seen = f'{count} of them, and {others} of another publisher at the same time'
        why = 'Two publish at once. The robot would hear both.'
        todo = 'End all but one, and run the command once more.'
    elif count < COUNT and first > 1 and first - 1 not in {s.number for s in samples}:
        seen = f'the last {count} of {last}'
        why = 'The first ones were sent before anybody listened.'
        todo = 'Wait for a subscriber before you publish; --times does so.'
    elif count < COUNT:
        why = '--once sends one message. --times says how many are to be sent.'
    expect.that(
        count == COUNT and not others,
        expected=f'{COUNT} messages on {TOPIC}, of one command',
        seen=seen,
        why=why,
        todo=todo,
    )


def _expect_rate(sent: Sent) -> None:
    run = newest_run(sent.samples)
    expect.that(
        is_every(PERIOD_SEC, run, commanded_rate(TOPIC)),
        expected=f'a message every {PERIOD_SEC} s (8.5 to 11.5 a second)',
        seen=f'a message every {period(run):.3g} s ({1 / period(run):.3g} a second)',
        why='The option --rate says how many messages are sent in a second. Without it, it is 1.',
        todo='Use --rate 10.',
    )


_WHERE = OnTopic(TOPIC, TWIST)
_CLAUSES = (
    Asked(
        f'forwards at {FORWARD} m/s (`linear`, `x`), turning to the left at {LEFT} rad/s '
        '(`angular`, `z`), all other fields 0, in every message',
        _expect_fields,
    ),
    Asked(
        f'five messages (`--times {COUNT}`) of one command, no more and no fewer', _expect_count
    ),
    Asked('ten a second (`--rate 10`); the check allows 8.5 to 11.5', _expect_rate),
)

drive = Exercise(
    name='drive',
    task='Let a robot drive, from the command line.',
    clauses=[_WHERE, *_CLAUSES],
    publishes={TOPIC: TWIST},
    shared=[TOPIC],
    reliable=[TOPIC],
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
        Style('in the background', f'{_LINE.rstrip()} &\n'),
        Style('as in a terminal', changed(_LINE, ('%', '!'))),
        Style(
            'YAML in lines, fields in another order',
            '''
twist = """
angular:
  z: 0.5
linear:
  x: 0.2
"""
!ros2 topic pub -t 5 -r 10 /cmd_vel geometry_msgs/Twist "$twist"
''',
        ),
        Style('twice', _LINE * 2),
        Style('after one message', _ONCE + _LINE),
        Style(
            'a program',
            """
import time

import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.left = 5
        self.timer = self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        if self.left and self.publisher.get_subscription_count():
            self.publisher.publish(Twist(linear=Vector3(x=0.2), angular=Vector3(z=0.5)))
            self.left -= 1


rclpy.init()
driver = Driver()
while driver.left:
    rclpy.spin_once(driver)
time.sleep(1)
""",
            process=True,
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
        Wrong('a little too slow', changed(_LINE, ('--rate 10', '--rate 8')), 'Use --rate 10.'),
        Wrong('a little too fast', changed(_LINE, ('--rate 10', '--rate 12.5')), 'Use --rate 10.'),
        Wrong(
            'too slow, in the background',
            f'{changed(_LINE, ("--rate 10", "--rate 2")).rstrip()} &\n',
            'Use --rate 10.',
        ),
        Wrong('one more', changed(_LINE, ('--times 5', '--times 6')), '6 of them'),
        Wrong(
            'a sideways speed',
            changed(_LINE, ('0.2}', '0.2, y: 0.1}')),
            'Fields that are not named stay 0.',
        ),
        Wrong('not a number', changed(_LINE, ('0.2}', '0.2, y: .nan}')), 'nan is none'),
        Wrong('another speed', changed(_LINE, ('0.2', '0.25')), 'linear.x = 0.25'),
        Wrong(
            'the last one is another',
            """
import rclpy
from geometry_msgs.msg import Twist

node = lab.spin(rclpy.create_node('driver'))
publisher = node.create_publisher(Twist, 'cmd_vel', 10)
twist = Twist()
twist.linear.x, twist.angular.z = 0.2, 0.5
rate = node.create_rate(10)
for _ in range(4):
    publisher.publish(twist)
    rate.sleep()
publisher.publish(Twist())
""",
            'all fields are 0',
        ),
        Wrong(
            'another topic, too',
            _LINE + changed(_ONCE, ('/cmd_vel', '/wheels -w 0')),
            'messages on /wheels as well',
        ),
        Wrong('other topic', changed(_ONCE, ('/cmd_vel', '/cmdvel -w 0')), 'is not /cmd_vel'),
    ],
    records=[TOPIC],
)
