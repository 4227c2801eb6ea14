"""Answers to `site`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'volatile',
        'A number alone as the last argument is the depth',
        ('QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)', '10'),
    ),
    wrong('keeps ten', 'keeps as many messages as its depth says', ('depth=1,', 'depth=10,')),
    wrong('keeps two', 'Give the profile of the publisher depth=1.', ('depth=1,', 'depth=2,')),
    wrong(
        'a lifespan',
        'Who subscribes 0.3 s later hears nothing.',
        ('from rclpy.node', 'from rclpy.duration import Duration\nfrom rclpy.node'),
        (
            'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)',
            'QoSProfile(\n            depth=1,\n'
            '            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n'
            '            lifespan=Duration(seconds=0.3),\n        )',
        ),
    ),
    wrong(
        'best effort keeps nothing',
        'with reliability reliable',
        (
            'import DurabilityPolicy, QoSProfile\n',
            'import DurabilityPolicy, QoSProfile, ReliabilityPolicy\n',
        ),
        (
            'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)',
            'QoSProfile(\n            depth=1,\n'
            '            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n'
            '            reliability=ReliabilityPolicy.BEST_EFFORT,\n        )',
        ),
    ),
    wrong(
        'a timer repeats it',
        'The answer is repeated, again and again',
        (
            "        self.publisher = self.create_publisher(String, 'site', profile)\n",
            "        self.publisher = self.create_publisher(String, 'site', profile)\n"
            '        self.name = String()\n'
            '        self.create_timer(0.1, self.on_timer)\n',
        ),
        (
            '        self.publisher.publish(msg)\n',
            '        self.name = msg\n\n    def on_timer(self):\n'
            '        self.publisher.publish(self.name)\n',
        ),
    ),
    wrong(
        'the subscription keeps',
        'does not match that of a usual publisher',
        ("'site', profile)", "'site', 10)"),
        ("'move', self.on_move, 10)", "'move', self.on_move, profile)"),
    ),
    wrong(
        'a publisher for each name',
        'makes a publisher again and again',
        (
            "        self.publisher = self.create_publisher(String, 'site', profile)\n",
            '        self.profile = profile\n',
        ),
        (
            'self.publisher.publish(msg)',
            "self.create_publisher(String, 'site', self.profile).publish(msg)",
        ),
    ),
    wrong(
        'publishes where it listens',
        'The node hears what it says itself',
        ("String, 'site', profile", "String, 'move', profile"),
    ),
    wrong('another topic', 'names must be equal to the last letter'),
    wrong(
        'publishes the text',
        'publish() takes a message of the type',
        ('publish(msg)', 'publish(msg.data)'),
        outcome=ERROR,
    ),
    wrong(
        'once only',
        'messages were answered correctly, the others were not',
        ("super().__init__('site')\n", "super().__init__('site')\n        self.n = 0\n"),
        (
            '        self.publisher.publish(msg)\n',
            '        self.n += 1\n        if self.n == 1:\n'
            '            self.publisher.publish(msg)\n',
        ),
    ),
    wrong(
        'volatile, in a process of its own',
        'with durability transient_local',
        (
            'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)',
            'QoSProfile(depth=1)',
        ),
        ('import DurabilityPolicy, QoSProfile', 'import QoSProfile'),
        run='process',
    ),
    right('functions'),
    right(
        'a list and a timer',
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
    right(
        'all policies written out, and a late joiner itself',
        (
            'import DurabilityPolicy, QoSProfile\n',
            'import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy\n',
        ),
        (
            'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)',
            'QoSProfile(\n            history=HistoryPolicy.KEEP_LAST,\n'
            '            depth=1,\n            reliability=ReliabilityPolicy.RELIABLE,\n'
            '            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n        )',
        ),
        ("'move', self.on_move, 10)", "'move', self.on_move, 1000)"),
    ),
]
