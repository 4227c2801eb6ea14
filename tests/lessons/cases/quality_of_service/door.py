"""Answers to `door`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'as it was',
        'best effort publisher and reliable subscription',
        (
            '        profile = QoSProfile(\n            depth=1,\n'
            '            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n'
            '            deadline=Duration(seconds=0.5),\n        )\n',
            '',
        ),
        ('from rclpy.duration import Duration\n', ''),
        (
            'from rclpy.qos import DurabilityPolicy, QoSProfile\n',
            'from rclpy.qos import qos_profile_sensor_data\n',
        ),
        ("'door', profile)", "'door', qos_profile_sensor_data)"),
    ),
    wrong(
        'the default profile',
        'volatile publisher and transient local subscription',
        (
            '        profile = QoSProfile(\n            depth=1,\n'
            '            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n'
            '            deadline=Duration(seconds=0.5),\n        )\n',
            '',
        ),
        ('from rclpy.duration import Duration\n', ''),
        (
            'from rclpy.qos import DurabilityPolicy, QoSProfile\n',
            'from rclpy.qos import qos_profile_sensor_data\n',
        ),
        ("'door', profile)", "'door', qos_profile_sensor_data)"),
        ('from rclpy.qos import qos_profile_sensor_data\n', ''),
        ("'door', qos_profile_sensor_data)", "'door', 10)"),
    ),
    wrong(
        'no deadline',
        'subscription has a deadline, but publisher does not',
        ('from rclpy.duration import Duration\n', ''),
        ('            deadline=Duration(seconds=0.5),\n', ''),
        (
            '        profile = QoSProfile(\n            depth=1,\n'
            '            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n        )\n',
            '        profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n',
        ),
    ),
    wrong(
        'a deadline that is too long',
        'subscription deadline is less than publisher deadline',
        ('seconds=0.5', 'seconds=2'),
    ),
    wrong(
        'a deadline alone',
        'change that of /door',
        ('            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n', ''),
        (
            'from rclpy.qos import DurabilityPolicy, QoSProfile\n',
            'from rclpy.qos import QoSProfile\n',
        ),
        (
            'QoSProfile(\n            depth=1,\n'
            '            deadline=Duration(seconds=0.5),\n        )',
            'QoSProfile(depth=1, deadline=Duration(seconds=0.5))',
        ),
    ),
    wrong(
        'a lock that asks for less', 'On a robot that end belongs to somebody else', run='process'
    ),
    wrong(
        'five seconds for five times a second',
        'A rate in Hz and a period in seconds were mixed up',
        ('create_timer(0.2,', 'create_timer(5,'),
    ),
    wrong(
        'counts',
        'data = 1 in each message on /door',
        ('        self.timer =', '        self.number = 0\n        self.timer ='),
        (
            '        self.publisher.publish(Int16(data=1))\n',
            '        self.number += 1\n        self.publisher.publish(Int16(data=self.number))\n',
        ),
    ),
    wrong('zero', 'data = 1 in each message on /door', ('Int16(data=1)', 'Int16()')),
    wrong('another topic', 'names must be equal to the last letter'),
    wrong(
        'a number of seconds for a Duration',
        'profile = QoSProfile(',
        ('from rclpy.duration import Duration\n', ''),
        ('deadline=Duration(seconds=0.5)', 'deadline=0.5'),
        outcome=ERROR,
    ),
    wrong(
        'no deadline, in a process of its own',
        'Where it asks for more than is offered, no message passes.',
        ('from rclpy.duration import Duration\n', ''),
        ('            deadline=Duration(seconds=0.5),\n', ''),
        ('depth=1,\n            durability', 'depth=1, durability'),
        ('QoSProfile(\n            depth', 'QoSProfile(depth'),
        ('LOCAL,\n        )', 'LOCAL)'),
        run='process',
    ),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    right('functions, and the deadline as the lock asks for it'),
    right(
        'offers what the graph says is asked for',
        (
            '        profile = QoSProfile(\n            depth=1,\n'
            '            durability=DurabilityPolicy.TRANSIENT_LOCAL,\n'
            '            deadline=Duration(seconds=0.5),\n        )\n',
            '        for info in self.get_subscriptions_info_by_topic("door"):\n'
            '            asked = info.qos_profile\n        profile = QoSProfile(\n'
            '            depth=1,\n            reliability=asked.reliability,\n'
            '            durability=asked.durability,\n'
            '            deadline=asked.deadline,\n        )\n',
        ),
        ('"door"', "'door'"),
        ('from rclpy.duration import Duration\n', ''),
        (
            'from rclpy.qos import DurabilityPolicy, QoSProfile\n',
            'from rclpy.qos import QoSProfile\n',
        ),
    ),
    right('a tighter deadline', ('seconds=0.5', 'seconds=0.3')),
]
