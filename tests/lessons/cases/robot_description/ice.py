"""Answers to `ice`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

_BY_WHEELS = (
    (
        'from rclpy.node',
        'from nav_msgs.msg import Odometry\nfrom rclpy.node',
    ),
    (
        '        self.timer =',
        "        self.create_subscription(Odometry, 'odom', self.on_odom, 10)\n"
        '        self.timer =',
    ),
    (
        '    def on_imu(self, msg):\n        q = msg.orientation\n',
        '    def on_imu(self, msg):\n        pass\n\n    def on_odom(self, msg):\n'
        '        q = msg.pose.pose.orientation\n',
    ),
)

ANSWERS = [
    wrong('by wheels', 'counts how far the wheels turn', *_BY_WHEELS),
    wrong(
        'by nothing but the wheels',
        'subscription to /imu',
        *_BY_WHEELS,
        ("        self.create_subscription(Imu, 'imu', self.on_imu, 10)\n", ''),
    ),
    wrong(
        'to the left all the time', 'not against the error of its heading', ('3 * error', '0.3')
    ),
    wrong(
        'degrees for radians', 'Its angles are degrees', ('3 * error', '3 * math.degrees(error)')
    ),
    wrong(
        'eight commands a second',
        'a command every 0.125 s (8 Hz)',
        ('create_timer(0.1,', 'create_timer(0.125,'),
    ),
    wrong(
        'two drives and no more',
        'drives after 2 of them, and nothing after the next one',
        (
            '        self.steps = 100\n',
            "        self.count = getattr(self, 'count', 0) + 1\n"
            '        if self.count <= 2:\n            self.steps = 100\n',
        ),
    ),
    wrong(
        'forgets to stop',
        'leaves it driving',
        ('        if self.steps < 0:\n', '        if self.steps <= 0:\n'),
    ),
    wrong(
        'drives all the time',
        'It publishes without being asked to.',
        ('self.steps = -1', 'self.steps = 20\n        self.wanted = 0.0'),
    ),
    wrong(
        'only to the left',
        'not against the error of its heading',
        ('3 * error', 'max(0.0, 3 * error)'),
    ),
    wrong(
        'an int in a float field', 'takes values of type float', ('= 0.2', '= 1'), outcome=ERROR
    ),
    right('by twice the error', ('3 * error', '2.5 * error')),
    right('strongly, and limited', ('3 * error', 'max(-1.5, min(1.5, 8 * error))')),
    right(
        'by a gyroscope alone',
        (
            '        q = msg.orientation\n        self.yaw = 2 * math.atan2(q.z, q.w)\n',
            '        self.yaw += msg.angular_velocity.z / 30\n',
        ),
    ),
    right(
        'and the sum of the errors',
        ('        self.steps = 100\n', '        self.steps = 100\n        self.sum = 0.0\n'),
        ('3 * error', '3 * error + self.add(error)'),
        (
            '    def on_timer(self):\n',
            '    def add(self, error):\n        self.sum += 0.1 * error\n'
            '        return 2 * self.sum\n\n    def on_timer(self):\n',
        ),
    ),
]
