"""Answers to `go_to`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'only x',
        'it stands at x = ',
        ('math.hypot(dx, dy) <', 'abs(dx) <'),
    ),
    wrong(
        'only y',
        'it stands at x = ',
        ('math.hypot(dx, dy) <', 'abs(dy) <'),
    ),
    wrong(
        'degrees for radians',
        'Its angles are degrees',
        ('1.5 * error', '1.5 * math.degrees(error)'),
    ),
    wrong(
        'the heading in degrees',
        'Degrees and radians are mixed.',
        ('2 * math.atan2(q.z, q.w)', 'math.degrees(2 * math.atan2(q.z, q.w))'),
    ),
    wrong(
        'the direction in degrees, and a limit',
        'Degrees and radians are mixed.',
        ('= math.atan2(dy, dx) - self.yaw', '= math.degrees(math.atan2(dy, dx)) - self.yaw'),
        ('1.5 * error', 'max(-1.0, min(1.0, 1.5 * error))'),
    ),
    wrong(
        'to the left all the time',
        'or turns elsewhere, to and fro or round and round',
        ('1.5 * error', '0.8'),
    ),
    wrong(
        'radians of radians',
        'It drives or turns too slowly',
        ('1.5 * error', '1.5 * math.radians(error)'),
    ),
    wrong(
        'not wrapped',
        'was not wrapped',
        ('        error = math.atan2(math.sin(error), math.cos(error))\n', ''),
    ),
    wrong(
        'forgets to stop',
        'leaves it driving',
        ('            self.goal = None\n', '            self.goal = None\n            return\n'),
    ),
    wrong(
        'the first time only',
        'Something is used up by the first drive',
        ('        self.publisher =', '        self.used = False\n        self.publisher ='),
        (
            '        self.goal = msg\n',
            '        if not self.used:\n            self.used = True\n'
            '            self.goal = msg\n',
        ),
    ),
    wrong(
        'odometry from another topic',
        'subscription to /odom',
        ("Odometry, 'odom'", "Odometry, 'odometry'"),
    ),
    wrong(
        'eight commands a second',
        'a command every 0.125 s (8 Hz)',
        ('create_timer(0.1,', 'create_timer(0.125,'),
    ),
    wrong('too slow', 'after the message', ('= 0.2', '= 0.02')),
    wrong(
        'four drives and no more',
        'drives after 4 of them, and nothing after the next one',
        (
            '        self.goal = msg\n',
            "        self.count = getattr(self, 'count', 0) + 1\n"
            '        if self.count <= 4:\n            self.goal = msg\n',
        ),
    ),
    right(
        'rests on its way',
        ('        self.goal = None\n\n', '        self.goal = None\n        self.rests = 1\n\n'),
        (
            '        if math.hypot',
            '        if math.hypot(dx, dy) < 0.3 and self.rests:\n'
            '            self.rests = 0\n        elif math.hypot',
        ),
    ),
    wrong(
        'a root of a number below 0',
        'linear.z = nan',
        ('= 1.5 * error', "= 1.5 * error if dx else 0.0\n            msg.linear.z = float('nan')"),
    ),
    wrong(
        'an int in a float field', 'takes values of type float', ('= 0.2', '= 1'), outcome=ERROR
    ),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    wrong('a crawl', 'after the message', ('= 0.2', '= 0.03')),
    wrong(
        'wraps what is too large only',
        'was not wrapped',
        (
            '        error = math.atan2(math.sin(error), math.cos(error))\n',
            '        if error > math.pi:\n            error -= math.tau\n',
        ),
    ),
    wrong(
        'wraps what is too small only',
        'was not wrapped',
        (
            '        error = math.atan2(math.sin(error), math.cos(error))\n',
            '        if error < -math.pi:\n            error += math.tau\n',
        ),
    ),
    right(
        'turns while it drives',
        ('            if abs(error) < 0.5:\n                msg', '            msg'),
        ('= 0.2', '= max(0.0, 0.2 * math.cos(error))'),
    ),
    right(
        'backs up where that is shorter, never',
        ('1.5 * error', 'max(-2.0, min(2.0, 3.0 * error))'),
    ),
    right(
        'by math.remainder, with a cosine',
        ('math.atan2(math.sin(error), math.cos(error))', 'math.remainder(error, math.tau)'),
        (
            '            if abs(error) < 0.5:\n                msg.linear.x = 0.2\n',
            '            msg.linear.x = 0.15 * max(0.0, math.cos(error)) ** 3\n',
        ),
    ),
    right(
        'each tenth call of a fast timer',
        ('create_timer(0.1,', 'create_timer(0.01,'),
        ('        self.goal = None\n\n', '        self.goal = None\n        self.calls = 0\n\n'),
        (
            '        if self.goal is None:\n',
            '        self.calls += 1\n        if self.goal is None or self.calls % 10:\n',
        ),
    ),
]
