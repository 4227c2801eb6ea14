"""Exercise: keep the newest message for who comes later."""

from __future__ import annotations

from collections.abc import Sequence

from labkit.exercises import Exercise, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Answers, Latched
from labkit.exercises.draws import draw_texts
from labkit.lessons._script import in_process, started_by_subprocess

__all__ = ['site']

STRING = 'std_msgs/msg/String'

_SITE = """
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


class Site(Node):
    def __init__(self):
        super().__init__('site')
        profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, 'site', profile)
        self.subscription = self.create_subscription(String, 'move', self.on_move, 10)

    def on_move(self, msg):
        self.publisher.publish(msg)


site = lab.spin(Site())
"""
_KEPT = 'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)'
_PUBLISHER = "        self.publisher = self.create_publisher(String, 'site', profile)\n"


def _explain(text: str, came: Sequence[str]) -> tuple[str, str]:
    if text and came and text in came[-1]:
        return (
            'More than the name is published.',
            'Publish the message as it came: self.publisher.publish(msg)',
        )
    return '', ''


site = Exercise(
    name='site',
    task='Publish each name that comes on /move on /site, and keep the newest one for who '
    'subscribes later.',
    subscribes={'/move': STRING},
    publishes={'/site': STRING},
    clauses=(
        Answers(
            '/move',
            '/site',
            'for each name on `/move`, publish that name on `/site` (both `std_msgs/msg/String`), '
            'once, within a second',
            answer=lambda text: text,
            draw=draw_texts,
            explain=_explain,
        ),
        Latched(
            '/site',
            'who subscribes to `/site` later, and asks for transient local, hears the newest name '
            'at once, and no older one',
        ),
    ),
    hints=[
        'Which policy lets a publisher keep what it has said?',
        'The durability is transient local. How many messages are kept is the depth.',
        'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL) is the last argument of '
        'create_publisher().',
    ],
    answer=Solution(
        _SITE,
        'The publisher keeps one message, the newest. So it publishes when something has changed, '
        'and needs no timer that repeats it for late ones.',
    ),
    styles=[
        Style(
            'functions',
            """
import rclpy
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from std_msgs.msg import String

node = rclpy.create_node('builder')
profile = QoSProfile(depth=1)
profile.durability = QoSDurabilityPolicy.TRANSIENT_LOCAL
publisher = node.create_publisher(String, '/site', profile)
node.create_subscription(String, '/move', publisher.publish, 10)
lab.spin(node)
""",
        ),
        Style(
            'a list and a timer',
            changed(
                _SITE,
                (
                    "        self.subscription = self.create_subscription(String, 'move', "
                    'self.on_move, 10)\n',
                    '        self.waiting = []\n'
                    "        self.create_subscription(String, 'move', self.waiting.append, 10)\n"
                    '        self.create_timer(0.05, self.on_timer)\n',
                ),
                (
                    '    def on_move(self, msg):\n        self.publisher.publish(msg)\n',
                    '    def on_timer(self):\n        while self.waiting:\n'
                    '            self.publisher.publish(self.waiting.pop(0))\n',
                ),
            ),
        ),
        Style(
            'all policies written out, and a late joiner itself',
            changed(
                _SITE,
                (
                    'import DurabilityPolicy, QoSProfile\n',
                    'import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy\n',
                ),
                (
                    _KEPT,
                    'QoSProfile(\n            history=HistoryPolicy.KEEP_LAST,\n'
                    '            depth=1,\n'
                    '            reliability=ReliabilityPolicy.RELIABLE,\n'
                    '            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n        )',
                ),
                ("'move', self.on_move, 10)", "'move', self.on_move, 1000)"),
            ),
        ),
        Style('own process, started here', started_by_subprocess(in_process(_SITE))),
        Style('own process', in_process(_SITE), process=True),
    ],
    wrong=[
        Wrong(
            'volatile',
            changed(_SITE, (_KEPT, '10')),
            'A number alone as the last argument is the depth',
        ),
        Wrong(
            'keeps ten',
            changed(_SITE, ('depth=1,', 'depth=10,')),
            'keeps as many messages as its depth says',
        ),
        Wrong(
            'keeps two',
            changed(_SITE, ('depth=1,', 'depth=2,')),
            'Give the profile of the publisher depth=1.',
        ),
        Wrong(
            'best effort keeps nothing',
            changed(
                _SITE,
                (
                    'import DurabilityPolicy, QoSProfile\n',
                    'import DurabilityPolicy, QoSProfile, ReliabilityPolicy\n',
                ),
                (
                    _KEPT,
                    'QoSProfile(\n            depth=1,\n'
                    '            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n'
                    '            reliability=ReliabilityPolicy.BEST_EFFORT,\n        )',
                ),
            ),
            'with reliability reliable',
        ),
        Wrong(
            'a timer repeats it',
            changed(
                _SITE,
                (
                    _PUBLISHER,
                    f'{_PUBLISHER}        self.name = String()\n'
                    '        self.create_timer(0.1, self.on_timer)\n',
                ),
                (
                    '        self.publisher.publish(msg)\n',
                    '        self.name = msg\n\n    def on_timer(self):\n'
                    '        self.publisher.publish(self.name)\n',
                ),
            ),
            'The answer is repeated, again and again',
        ),
        Wrong(
            'the subscription keeps',
            changed(
                _SITE,
                ("'site', profile)", "'site', 10)"),
                ("'move', self.on_move, 10)", "'move', self.on_move, profile)"),
            ),
            'does not match that of a usual publisher',
        ),
        Wrong(
            'a publisher for each name',
            changed(
                _SITE,
                (_PUBLISHER, '        self.profile = profile\n'),
                (
                    'self.publisher.publish(msg)',
                    "self.create_publisher(String, 'site', self.profile).publish(msg)",
                ),
            ),
            'makes a publisher again and again',
        ),
        Wrong(
            'publishes where it listens',
            changed(_SITE, ("String, 'site', profile", "String, 'move', profile")),
            'The node hears what it says itself',
        ),
        Wrong(
            'other topic',
            changed(_SITE, ("String, 'site', profile", "String, 'sites', profile")),
            'names must be equal to the last letter',
        ),
        Wrong(
            'adds a word',
            changed(_SITE, ('publish(msg)', "publish(String(data=f'site {msg.data}'))")),
            'More than the name is published.',
        ),
        Wrong(
            'publishes the text',
            changed(_SITE, ('publish(msg)', 'publish(msg.data)')),
            'publish() takes a message of the type',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'once only',
            changed(
                _SITE,
                ("super().__init__('site')\n", "super().__init__('site')\n        self.n = 0\n"),
                (
                    '        self.publisher.publish(msg)\n',
                    '        self.n += 1\n        if self.n == 1:\n'
                    '            self.publisher.publish(msg)\n',
                ),
            ),
            'messages were answered rightly, others not',
        ),
        Wrong('not spun', changed(_SITE, ('lab.spin(Site())', 'Site()')), 'lab.spin(node)'),
        Wrong(
            'volatile, in a process of its own',
            changed(
                in_process(_SITE),
                (_KEPT, 'QoSProfile(depth=1)'),
                ('import DurabilityPolicy, QoSProfile', 'import QoSProfile'),
            ),
            'with durability transient_local',
            process=True,
        ),
    ],
)
