"""Answers to `silent_mast`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

HEARS = (
    '        self.subscription = self.create_subscription(\n'
    '            Int16, hears, self.on_level, qos_profile_sensor_data\n'
    '        )\n'
)
# A program of its own has to find the others first.
WAITS = (
    '        hears, says = self.silent_link()\n',
    "        topics = ['level', 'level_a', 'level_b', 'level_c']\n"
    '        for count in (self.count_publishers, self.count_subscribers):\n'
    '            while not all(map(count, topics)):\n'
    '                time.sleep(0.1)\n'
    '        hears, says = self.silent_link()\n',
)
TIME = ('from itertools import pairwise\n', 'import time\nfrom itertools import pairwise\n')

ANSWERS = [
    wrong(
        'the default profile',
        'best effort publisher and reliable subscription',
        ('hears, self.on_level, qos_profile_sensor_data', 'hears, self.on_level, 10'),
    ),
    wrong(
        'best effort, but transient local',
        'olatile publisher and transient local subscription',
        (
            HEARS,
            '        profile = QoSProfile(\n            depth=5,\n'
            '            reliability=ReliabilityPolicy.BEST_EFFORT,\n'
            '            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n        )\n'
            '        self.create_subscription(Int16, hears, self.on_level, profile)\n',
        ),
        (', qos_profile_sensor_data\n', '\n'),
        (
            'from std_msgs',
            'from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy\nfrom std_msgs',
        ),
    ),
    wrong(
        'the sensor profile at both ends',
        'change that of /spare_mast',
        ('says, 10)', 'says, qos_profile_sensor_data)'),
    ),
    wrong(
        'all three links at once',
        'the same number comes more than once',
        (
            'spare_mast = lab.spin(SpareMast())',
            'spare_mast = lab.spin(SpareMast())\n'
            "for hears, says in pairwise(['level', 'level_a', 'level_b', 'level_c']):\n"
            '    node = lab.spin(Node(f"to_{says}"))\n'
            '    publisher = node.create_publisher(Int16, says, 10)\n'
            '    node.create_subscription(\n'
            '        Int16, hears, publisher.publish, qos_profile_sensor_data\n    )\n',
        ),
        ('f"to_{says}"', "f'to_{says}'"),
    ),
    wrong(
        'hears its own topic',
        'The node hears what it says itself',
        ('Int16, hears, self', 'Int16, says, self'),
    ),
    wrong(
        'hears something else',
        'and does not hear',
        ('Int16, hears, self', "Int16, 'water', self"),
    ),
    wrong(
        'publishes elsewhere',
        'Take the place of the mast that hears nothing',
        ('Int16, says, 10', "Int16, 'repaired', 10"),
    ),
    wrong('in a namespace', 'not enough values to unpack', outcome=ERROR),
    wrong('publishes twice', 'the same number comes more than once'),
    wrong(
        'a number each second',
        'Not each number is passed on.',
        (
            '        self.publisher.publish(msg)\n',
            '        self.msg = msg\n\n    def on_timer(self):\n'
            '        self.publisher.publish(self.msg)\n',
        ),
        (
            '        self.subscription',
            '        self.create_timer(1, self.on_timer)\n        self.subscription',
        ),
    ),
    right('functions'),
    right(
        'a profile of its own',
        ('hears, self.on_level, qos_profile_sensor_data', 'hears, self.on_level, profile'),
        (
            '        self.subscription',
            '        profile = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)\n'
            '        self.subscription',
        ),
        (', qos_profile_sensor_data\n', '\n'),
        (
            'from std_msgs',
            'from rclpy.qos import QoSProfile, ReliabilityPolicy\nfrom std_msgs',
        ),
    ),
    right(
        'the profile that is offered',
        (
            HEARS,
            '        (source,) = self.get_publishers_info_by_topic(hears)\n'
            '        offered = source.qos_profile.reliability\n'
            '        profile = QoSProfile(depth=5, reliability=offered)\n'
            '        self.create_subscription(Int16, hears, self.on_level, profile)\n',
        ),
        ('QoSCompatibility, qos_check', 'QoSCompatibility, QoSProfile, qos_check'),
        (', qos_profile_sensor_data\n', '\n'),
    ),
    right(
        'hears the gauge',
        (
            '        self.publisher = ',
            "        hears = 'level'\n        self.publisher = ",
        ),
    ),
    right('own process', TIME, WAITS, run='process'),
    right('own process, by subprocess', TIME, WAITS, run='subprocess'),
    right('own process, by asyncio', TIME, WAITS, run='asyncio'),
]
