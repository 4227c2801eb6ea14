"""Answers to `silent_mast`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

HEARS = (
    '        self.subscription = self.create_subscription(\n'
    '            Int16, hears, self.on_level, qos_profile_sensor_data\n'
    '        )\n'
)
LINK = '        hears, says = self.silent_link()\n'
# A program of its own has to find the others first.
WAITS = (
    LINK,
    '        while not all(self.count_publishers(t) and self.count_subscribers(t) '
    'for t, _ in LINKS):\n'
    f'            rclpy.spin_once(self, timeout_sec=0.1)\n{LINK}',
)
IMPORT = 'from rclpy.qos import QoSCompatibility, qos_check_compatible, qos_profile_sensor_data\n'
ONE_LINE = (
    '        self.subscription = self.create_subscription(Int16, hears, self.on_level, {})\n'
)

ANSWERS = [
    wrong(
        'ten numbers',
        'Not each number is passed on.',
        (
            '        self.publisher.publish(msg)',
            "        self.count = getattr(self, 'count', 0) + 1\n        if self.count <= 10:\n"
            '            self.publisher.publish(msg)',
        ),
    ),
    wrong(
        'fails at the twentieth',
        'RuntimeError: enough',
        (
            '        self.publisher.publish(msg)',
            "        self.count = getattr(self, 'count', 0) + 1\n        if self.count > 20:\n"
            "            raise RuntimeError('enough')\n        self.publisher.publish(msg)",
        ),
        outcome=ERROR,
    ),
    wrong(
        'the default profile',
        'best effort publisher and reliable subscription',
        (HEARS, ONE_LINE.format(10)),
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
        (
            IMPORT,
            'from rclpy.qos import (\n    DurabilityPolicy,\n    QoSCompatibility,\n'
            '    QoSProfile,\n    ReliabilityPolicy,\n    qos_check_compatible,\n)\n',
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
            'spare_mast = lab.spin(SpareMast())\n',
            'spare_mast = lab.spin(SpareMast())\n'
            'for hears, says in LINKS:\n'
            "    node = lab.spin(Node(f'to_{says}'))\n"
            '    publisher = node.create_publisher(Int16, says, 10)\n'
            '    node.create_subscription(Int16, hears, publisher.publish, '
            'qos_profile_sensor_data)\n',
        ),
    ),
    wrong(
        'hears its own topic',
        'The node hears what it says itself',
        ('Int16, hears, self', 'Int16, says, self'),
        ('hears, says = self', '_, says = self'),
    ),
    wrong(
        'hears something else',
        'and does not hear',
        ('Int16, hears, self', "Int16, 'water', self"),
        ('hears, says = self', '_, says = self'),
    ),
    wrong(
        'publishes elsewhere',
        'Take the place of the mast that hears nothing',
        ('Int16, says, 10', "Int16, 'repaired', 10"),
        ('hears, says = self', 'hears, _ = self'),
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
    wrong(
        'a timer repeats the newest',
        'Not each number is passed on.',
        (
            '        self.publisher.publish(msg)',
            '        self.newest = msg\n\n    def on_timer(self):\n'
            '        if self.newest is not None:\n            self.publisher.publish(self.newest)',
        ),
        (
            '        hears, says = self.silent_link()\n',
            '        hears, says = self.silent_link()\n        self.newest = None\n'
            '        self.timer = self.create_timer(0.1, self.on_timer)\n',
        ),
    ),
    wrong(
        'stops after twenty',
        'Not each number is passed on',
        (
            '        self.publisher.publish(msg)',
            "        self.count = getattr(self, 'count', 0) + 1\n        if self.count <= 20:\n"
            '            self.publisher.publish(msg)',
        ),
    ),
    right('functions'),
    right(
        'a profile of its own',
        (
            HEARS,
            '        profile = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)\n'
            f'{ONE_LINE.format("profile")}',
        ),
        (
            IMPORT,
            'from rclpy.qos import (\n    QoSCompatibility,\n    QoSProfile,\n'
            '    ReliabilityPolicy,\n    qos_check_compatible,\n)\n',
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
    right('own process', WAITS, run='process'),
    right('own process, by subprocess', WAITS, run='subprocess'),
    right('own process, by asyncio', WAITS, run='asyncio'),
]
