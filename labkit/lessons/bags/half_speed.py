"""Exercise: make a new bag of an old one, with a node in between."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from labkit.exercises import Exercise, Fail, NotAttempted, Probe, Solution, Style, Wrong, changed
from labkit.lessons.bags.content import Found, Is, IsThere, OnlyTopic, judge_bag

if TYPE_CHECKING:
    from labkit.bags.reader import BagMessage

__all__ = ['half_speed']

SOURCE, PATH = 'bags/commands', 'bags/slow'
INNER, OUTER = '/cmd_vel', '/slow/cmd_vel'
TWIST = 'geometry_msgs/msg/Twist'

_NODE = """
from geometry_msgs.msg import Twist
from rclpy.node import Node


class HalfSpeed(Node):
    def __init__(self):
        super().__init__('half_speed')
        self.publisher = self.create_publisher(Twist, 'slow/cmd_vel', 50)
        self.subscription = self.create_subscription(Twist, 'cmd_vel', self.on_command, 50)

    def on_command(self, msg):
        half = Twist()
        half.linear.x = msg.linear.x / 2
        half.angular.z = msg.angular.z / 2
        self.publisher.publish(half)


half_speed = lab.spin(HalfSpeed())
"""
_RUN = """
with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as recording:
    lab.play('bags/commands', '/cmd_vel', wait=True)
    recording.wait_for(30)
"""
_ALL = _NODE + _RUN


def _commands() -> list[tuple[float, float]]:
    """Return the commands of the given bag."""
    from labkit.bags.reader import open_bag

    with open_bag(SOURCE) as bag:
        return _numbers(list(bag.messages(INNER)))


def _numbers(messages: Sequence[BagMessage]) -> list[tuple[float, float]]:
    twists = [each.message for each in messages]
    return [(twist.linear.x, twist.angular.z) for twist in twists]


def _same(one: tuple[float, float], other: tuple[float, float], factor: float = 1.0) -> bool:
    return all(math.isclose(a, factor * b, abs_tol=1e-6) for a, b in zip(one, other, strict=True))


def _count(found: Found) -> None:
    count, wanted = len(found.messages), len(_commands())
    if count == wanted:
        return
    raise Fail(
        f'{wanted} messages on {OUTER}: as many as there are on {INNER} in {SOURCE}',
        f'{count}',
        why='The recording was not there from the first message to the last one.'
        if count < wanted
        else 'Commands came more than once: from a second node, or a second playing.',
        todo='Begin to record, then play to the end, then stop.'
        if count < wanted
        else 'Let one node publish, and play the bag once from its beginning.',
    )


def _values(found: Found) -> None:
    commands, seen = _commands(), _numbers(found.messages)
    for number, (command, value) in enumerate(zip(commands, seen, strict=True), start=1):
        if _same(value, command, 0.5):
            continue
        half = tuple(round(part / 2, 4) for part in command)
        why, todo = _explain(value, command)
        raise Fail(
            f'linear.x = {half[0]}, angular.z = {half[1]} in message {number}',
            f'linear.x = {value[0]:.4g}, angular.z = {value[1]:.4g}',
            why=why,
            todo=todo,
        )


def _explain(value: tuple[float, float], command: tuple[float, float]) -> tuple[str, str]:
    if _same(value, command):
        return (
            'The commands are in the bag as they were.',
            'Publish new messages in the callback, with half of each speed.',
        )
    if _same(value, command, 0.25):
        return 'The speeds were halved twice.', 'Let one node halve them, and once.'
    if _same(value, command, 2.0):
        return 'The speeds were doubled.', 'Divide by 2, or multiply by 0.5.'
    if _same((value[0], 0.0), (command[0] / 2, 0.0)):
        return (
            'linear.x is half of what it was, angular.z is not.',
            'Halve both: a robot that turns as fast as before drives another path.',
        )
    if _same((value[1], 0.0), (command[1] / 2, 0.0)):
        return (
            'angular.z is half of what it was, linear.x is not.',
            'Halve both speeds.',
        )
    return (
        'That is not half of the command at this place.',
        'Halve each command, and publish it in the callback, so that the order stays.',
    )


CLAUSES = [
    IsThere(PATH),
    OnlyTopic(OUTER, TWIST),
    Is(f'it has one message for each one on `{INNER}` in `{SOURCE}`', _count),
    Is('`linear.x` and `angular.z` are half of what they were there, in the same order', _values),
]


def _judge(probe: Probe) -> str:
    if not Path(SOURCE).is_dir():
        raise NotAttempted(f'There is no bag {SOURCE} yet. Run the cell that makes it.')
    return judge_bag(probe, CLAUSES)


half_speed = Exercise(
    name='half_speed',
    task='Make a bag with the commands of bags/commands at half the speed.',
    clauses=CLAUSES,
    judge=_judge,
    publishes={OUTER: TWIST},
    subscribes={INNER: TWIST},
    hints=[
        'Three things work together: something plays the old bag, a node hears it and publishes, '
        'and something records the new bag.',
        'Begin the recording before the playing, so that it hears the first message.',
        "with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as recording: and inside, "
        "lab.play('bags/commands', wait=True) and recording.wait_for(30)",
    ],
    answer=Solution(
        _ALL,
        'The node does not know that a bag plays. The recording begins first and ends last.',
    ),
    styles=[
        Style('faster', changed(_ALL, ("'/cmd_vel', wait=True", 'rate=5.0, wait=True'))),
        Style(
            'other ends',
            changed(
                _ALL,
                (
                    _RUN,
                    """
recording = lab.record('bags/slow', regex='^/slow/', overwrite=True, storage='sqlite3')
playing = lab.play('bags/commands', paused=True)
playing.resume()
playing.wait()
recording.wait_for(30, '/slow/cmd_vel')
recording.stop()
""",
                ),
            ),
        ),
        Style(
            'remapped',
            changed(
                _ALL,
                ("Twist, 'cmd_vel'", "Twist, 'fast'"),
                ("'/cmd_vel', wait=True", "remap={'/cmd_vel': '/fast'}, wait=True"),
            ),
        ),
        Style(
            'changes the message that came',
            changed(
                _ALL,
                (
                    '        half = Twist()\n'
                    '        half.linear.x = msg.linear.x / 2\n'
                    '        half.angular.z = msg.angular.z / 2\n'
                    '        self.publisher.publish(half)\n',
                    '        msg.linear.x *= 0.5\n'
                    '        msg.angular.z *= 0.5\n'
                    '        self.publisher.publish(msg)\n',
                ),
            ),
        ),
        Style(
            'reads the bag itself',
            """
from geometry_msgs.msg import Twist
from rclpy.node import Node

node = lab.spin(Node('half_speed'))
publisher = node.create_publisher(Twist, 'slow/cmd_vel', 50)
with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as recording:
    for found in lab.bag('bags/commands').messages('/cmd_vel'):
        half = found.message
        half.linear.x /= 2
        half.angular.z /= 2
        publisher.publish(half)
    recording.wait_for(30)
""",
        ),
    ],
    wrong=[
        Wrong(
            'plays first, then records',
            changed(
                _ALL,
                (
                    _RUN,
                    """
lab.play('bags/commands', '/cmd_vel', rate=10.0, wait=True)
with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as recording:
    pass
""",
                ),
            ),
            'The recording had ended before the first message came.',
        ),
        Wrong(
            'does not wait',
            changed(_ALL, (', wait=True', ''), ('wait_for(30)', 'wait_for(3)')),
            'Begin to record, then play to the end, then stop.',
        ),
        Wrong(
            'begins in the middle',
            changed(
                _ALL, ('wait=True', 'start_offset=0.8, wait=True'), ('wait_for(30)', 'wait_for(5)')
            ),
            'The recording was not there from the first message to the last one.',
        ),
        Wrong(
            'records all',
            changed(_ALL, ("'/slow/cmd_vel', overwrite", 'overwrite')),
            'All that is published was recorded',
        ),
        Wrong(
            'records both',
            changed(_ALL, ("'/slow/cmd_vel', overwrite", "regex='cmd_vel', overwrite")),
            'More was chosen than the one topic.',
        ),
        Wrong(
            'remapped only',
            """
names = {'/cmd_vel': '/slow/cmd_vel'}
with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as recording:
    playing = lab.play('bags/commands', '/cmd_vel', remap=names, paused=True)
    lab.wait_until(lambda: '/slow/cmd_vel' in recording.counts)
    playing.resume()
    recording.wait_for(30)
""",
            'The commands are in the bag as they were.',
        ),
        Wrong(
            'angular.z as it was',
            changed(_ALL, ('msg.angular.z / 2', 'msg.angular.z')),
            'linear.x is half of what it was, angular.z is not.',
        ),
        Wrong(
            'linear.x as it was',
            changed(_ALL, ('msg.linear.x / 2', 'msg.linear.x')),
            'angular.z is half of what it was, linear.x is not.',
        ),
        Wrong(
            'a quarter',
            changed(_ALL, ('msg.linear.x / 2', 'msg.linear.x / 4'), ('z / 2', 'z / 4')),
            'The speeds were halved twice.',
        ),
        Wrong(
            'doubled',
            changed(_ALL, ('msg.linear.x / 2', 'msg.linear.x * 2'), ('z / 2', 'z * 2')),
            'The speeds were doubled.',
        ),
        Wrong(
            'played twice',
            changed(
                _ALL,
                (
                    '    recording.wait_for(30)\n',
                    "    lab.play('bags/commands', '/cmd_vel', wait=True)\n"
                    '    recording.wait_for(60)\n',
                ),
            ),
            'Commands came more than once',
        ),
        Wrong(
            'publishes what came, too',
            changed(
                _ALL,
                (
                    '        self.publisher.publish(half)\n',
                    '        self.publisher.publish(msg)\n        self.publisher.publish(half)\n',
                ),
                ('wait_for(30)', 'wait_for(60)'),
            ),
            'Commands came more than once',
        ),
        Wrong(
            'another topic',
            changed(
                _ALL,
                ("Twist, 'slow/cmd_vel'", "Twist, 'cmd_vel/slow'"),
                ("'/slow/cmd_vel', overwrite", "'/cmd_vel/slow', overwrite"),
            ),
            'What was recorded is another topic.',
        ),
        Wrong(
            'not ended',
            changed(_ALL, (_RUN, "\nlab.record('bags/slow', '/slow/cmd_vel', overwrite=True)\n")),
            'A recording goes on until it is ended',
        ),
    ],
)
