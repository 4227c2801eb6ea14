"""Exercise: find what does not match, and mend the one end that is yours."""

from __future__ import annotations

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Matches, Publishes, Says
from labkit.lessons._script import in_process, started_by_subprocess
from labkit.lessons.quality_of_service.lock import NODE, TOPIC, is_untouched

__all__ = ['door']

INT16 = 'std_msgs/msg/Int16'

_DOOR = """
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Int16


class Door(Node):
    def __init__(self):
        super().__init__('door')
        profile = QoSProfile(
            depth=1,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
            deadline=Duration(seconds=0.5),
        )
        self.publisher = self.create_publisher(Int16, 'door', profile)
        self.timer = self.create_timer(0.2, self.on_timer)

    def on_timer(self):
        self.publisher.publish(Int16(data=1))


door = lab.spin(Door())
"""
_PROFILE = """        profile = QoSProfile(
            depth=1,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
            deadline=Duration(seconds=0.5),
        )
"""
_DURATION = 'from rclpy.duration import Duration\n'
_QOS = 'from rclpy.qos import DurabilityPolicy, QoSProfile\n'
_SECOND_LOCK = """    lock = Node('lock')
    lock.create_subscription(Int16, 'door', print, 10)
"""


def _as_given(*changes: tuple[str, str]) -> str:
    """Return the starter's node, with the profile of sensors, or another one."""
    return changed(
        _DOOR,
        (_PROFILE, ''),
        (_DURATION, ''),
        (_QOS, 'from rclpy.qos import qos_profile_sensor_data\n'),
        ("'door', profile)", "'door', qos_profile_sensor_data)"),
        *changes,
    )


door = Exercise(
    name='door',
    task='Publish 1 on /door, five times a second, so that /lock hears it.',
    publishes={TOPIC: INT16},
    clauses=(
        Publishes(TOPIC, 5.0, INT16),
        Says(TOPIC, 1, words='the number is always 1'),
        Matches(
            TOPIC,
            NODE,
            '`/lock` hears the node, and `/lock` stays as it is',
            start='Run the cell with start_lock().',
            subscribes=True,
            is_as_given=is_untouched,
        ),
    ),
    hints=[
        'Start the door, and look: lab.doctor() says what the two ends disagree on.',
        'The lock asks for three policies: reliability, durability and deadline. '
        '%ros2 topic info --verbose /door shows what.',
        'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, '
        'deadline=Duration(seconds=0.5)), from rclpy.qos and rclpy.duration.',
    ],
    answer=Solution(
        _DOOR,
        'The door offers all that the lock asks for: reliable, which is the default, transient '
        'local, and a deadline of at most 1 s, which it keeps with a period of 0.2 s.',
    ),
    styles=[
        Style(
            'functions, and the deadline as the lock asks for it',
            """
import rclpy
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int16

node = rclpy.create_node('gate')
profile = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
profile.durability = DurabilityPolicy.TRANSIENT_LOCAL
profile.deadline = Duration(seconds=1)
publisher = node.create_publisher(Int16, '/door', profile)
node.create_timer(0.2, lambda: publisher.publish(Int16(data=1)))
lab.spin(node)
""",
        ),
        Style(
            'offers what the graph says is asked for',
            changed(
                _DOOR,
                (
                    _PROFILE,
                    '        for info in self.get_subscriptions_info_by_topic("door"):\n'
                    '            asked = info.qos_profile\n'
                    '        profile = QoSProfile(\n            depth=1,\n'
                    '            reliability=asked.reliability,\n'
                    '            durability=asked.durability,\n'
                    '            deadline=asked.deadline,\n        )\n',
                ),
                ('"door"', "'door'"),
                (_DURATION, ''),
                (_QOS, 'from rclpy.qos import QoSProfile\n'),
            ),
        ),
        Style('a tighter deadline', changed(_DOOR, ('seconds=0.5', 'seconds=0.3'))),
        Style('own process, started here', started_by_subprocess(in_process(_DOOR))),
        Style('own process', in_process(_DOOR), process=True),
    ],
    wrong=[
        Wrong('as it was', _as_given(), 'best effort publisher and reliable subscription'),
        Wrong(
            'the default profile',
            _as_given(
                ('from rclpy.qos import qos_profile_sensor_data\n', ''),
                ("'door', qos_profile_sensor_data)", "'door', 10)"),
            ),
            'volatile publisher and transient local subscription',
        ),
        Wrong(
            'no deadline',
            changed(
                _DOOR,
                (_DURATION, ''),
                ('            deadline=Duration(seconds=0.5),\n', ''),
                (
                    _PROFILE.replace('            deadline=Duration(seconds=0.5),\n', ''),
                    '        profile = QoSProfile(depth=1, '
                    'durability=DurabilityPolicy.TRANSIENT_LOCAL)\n',
                ),
            ),
            'subscription has a deadline, but publisher does not',
        ),
        Wrong(
            'a deadline that is too long',
            changed(_DOOR, ('seconds=0.5', 'seconds=2')),
            'subscription deadline is less than publisher deadline',
        ),
        Wrong(
            'a deadline alone',
            changed(
                _DOOR,
                ('            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n', ''),
                (_QOS, 'from rclpy.qos import QoSProfile\n'),
                (
                    'QoSProfile(\n            depth=1,\n            deadline='
                    'Duration(seconds=0.5),\n        )',
                    'QoSProfile(depth=1, deadline=Duration(seconds=0.5))',
                ),
            ),
            'change that of /door',
        ),
        Wrong(
            'a lock that asks for less',
            changed(
                in_process(_as_given()), ('    rclpy.spin(', _SECOND_LOCK + '    rclpy.spin(')
            ),
            'On a robot that end belongs to somebody else',
            process=True,
        ),
        Wrong(
            'five seconds for five times a second',
            changed(_DOOR, ('create_timer(0.2,', 'create_timer(5,')),
            'A rate in Hz and a period in seconds were mixed up',
        ),
        Wrong(
            'counts',
            changed(
                _DOOR,
                (
                    '        self.timer =',
                    '        self.number = 0\n        self.timer =',
                ),
                (
                    '        self.publisher.publish(Int16(data=1))\n',
                    '        self.number += 1\n'
                    '        self.publisher.publish(Int16(data=self.number))\n',
                ),
            ),
            'data = 1 in each message on /door',
        ),
        Wrong(
            'zero',
            changed(_DOOR, ('Int16(data=1)', 'Int16()')),
            'data = 1 in each message on /door',
        ),
        Wrong(
            'other topic',
            changed(_DOOR, ("Int16, 'door', profile", "Int16, 'doors', profile")),
            'names must be equal to the last letter',
        ),
        Wrong(
            'a number of seconds for a Duration',
            changed(_DOOR, (_DURATION, ''), ('deadline=Duration(seconds=0.5)', 'deadline=0.5')),
            'profile = QoSProfile(',
            outcome=Outcome.ERROR,
        ),
        Wrong('not spun', changed(_DOOR, ('lab.spin(Door())', 'Door()')), 'lab.spin(node)'),
        Wrong(
            'no deadline, in a process of its own',
            changed(
                in_process(_DOOR),
                (_DURATION, ''),
                ('            deadline=Duration(seconds=0.5),\n', ''),
                ('depth=1,\n            durability', 'depth=1, durability'),
                ('QoSProfile(\n            depth', 'QoSProfile(depth'),
                ('LOCAL,\n        )', 'LOCAL)'),
            ),
            'Where it asks for more than is offered, no message passes.',
            process=True,
        ),
    ],
)
