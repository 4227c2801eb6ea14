"""Answers to `distance`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'a limit that is a little too low',
        'Steps before this one were counted, and this one is not.',
        ('step < 0.5', 'step < 0.45'),
    ),
    wrong(
        'leaves out tiny steps',
        'The sum is wrong from this step on.',
        ('step < 0.5', '0.001 < step < 0.5'),
    ),
    wrong('a limit that is too high', 'The jump was counted', ('step < 0.5', 'step < 1.0')),
    wrong(
        'publishes only when something is added',
        'were answered correctly, the others were not',
        ('        self.publisher.publish(Float64(data=self.total))\n', ''),
        (
            '                self.total += step\n',
            '                self.total += step\n'
            '                self.publisher.publish(Float64(data=self.total))\n',
        ),
    ),
    wrong('publishes twice', 'A message is answered more than once.'),
    wrong(
        'does not publish',
        'its callback did not publish',
        ('        self.publisher.publish(Float64(data=self.total))\n', ''),
    ),
    wrong(
        'no place at first',
        'NoneType',
        ('        if self.last is not None:\n', '        if True:\n'),
        outcome=ERROR,
    ),
    wrong('listens elsewhere', '/odometry', ("Odometry, 'odom'", "Odometry, 'odometry'")),
    wrong('another topic', 'A slip of the pen?'),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    right(
        'hypot',
        (
            '            step = math.dist(self.last, place)\n',
            '            dx, dy = place[0] - self.last[0], place[1] - self.last[1]\n'
            '            step = math.hypot(dx, dy)\n',
        ),
    ),
    right(
        'numpy',
        ('import math\n\n', 'import numpy as np\n'),
        ('place = (position.x, position.y)', 'place = np.array([position.x, position.y])'),
        ('math.dist(self.last, place)', 'float(np.linalg.norm(place - self.last))'),
    ),
    right(
        'list of places',
        ('        self.last = None\n        self.total = 0.0\n', '        self.places = []\n'),
        (
            '        place = (position.x, position.y)\n'
            '        if self.last is not None:\n'
            '            step = math.dist(self.last, place)\n            if step < 0.5:\n'
            '                self.total += step\n        self.last = place\n'
            '        self.publisher.publish(Float64(data=self.total))\n',
            '        self.places.append((position.x, position.y))\n'
            '        steps = map(math.dist, self.places, self.places[1:])\n'
            '        total = sum(step for step in steps if step < 0.5)\n'
            '        self.publisher.publish(Float64(data=float(total)))\n',
        ),
    ),
    right('function'),
]
