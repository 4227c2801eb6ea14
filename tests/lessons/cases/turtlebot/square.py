"""Answers to `square`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong('degrees for radians', 'Its angles are degrees', ('1.5708', '90.0')),
    wrong('to the right', 'It turns to the right', ('1.5708', '-1.5708')),
    wrong('sides too long', 'the side has another length', ('20 *', '35 *')),
    wrong(
        'forgets to stop',
        'leaves it driving',
        ('4 * (side + turn)', '3 * (side + turn) + 17 * [(0.2, 0.0)]'),
    ),
    wrong(
        'the first time only',
        'Something is used up by the first drive',
        ('        self.publisher =', '        self.used = False\n        self.publisher ='),
        (
            '        self.plan = 4 * (side + turn)\n',
            '        if not self.used:\n            self.used = True\n'
            '            self.plan = 4 * (side + turn)\n',
        ),
    ),
    wrong(
        'drives before it is told to',
        'before the sign to start is given',
        ('        self.plan = []\n', '        self.plan = 5 * [(0.1, 0.0)] + [(0.0, 0.0)]\n'),
    ),
    wrong('two squares', 'It does not end', ('4 *', '8 *')),
    wrong(
        'twelve and a half commands a second',
        'a command every 0.08 s (12.5 Hz)',
        ('create_timer(0.1,', 'create_timer(0.08,'),
    ),
    wrong(
        'a circle',
        'The first side has another length',
        ('20 * [(0.2, 0.0)] + 2 * [(0.0, 0.0)]', '25 * [(0.178, 0.6283)]'),
        ('10 * [(0.0, 1.5708)] + 5 * [(0.0, 0.0)]', '[(0.0, 0.0)]'),
    ),
    wrong(
        'round corners',
        'It drives a curve',
        ('20 * [(0.2, 0.0)] + 2 * [(0.0, 0.0)]', '14 * [(0.2, 0.0)]'),
        ('10 * [(0.0, 1.5708)] + 5 * [(0.0, 0.0)]', '8 * [(0.15, 1.96)]'),
        ('(side + turn)', '(side + turn) + [(0.0, 0.0)]'),
    ),
    wrong(
        'never ends',
        'It does not end',
        (
            '        self.publisher.publish(msg)\n',
            '        self.publisher.publish(msg)\n        self.plan.append((v, w))\n',
        ),
    ),
    wrong(
        'says stop for ever',
        'no command before the sign to start',
        (
            '            return\n',
            '            self.publisher.publish(Twist())\n            return\n',
        ),
    ),
    wrong(
        'rests for long at its end',
        'It stands, and still publishes.',
        ('4 * (side + turn)', '4 * (side + turn) + 15 * [(0.0, 0.0)]'),
    ),
    wrong('too slow', 'after the message', ('20 * [(0.2, 0.0)]', '50 * [(0.08, 0.0)]')),
    wrong(
        'an int in a float field',
        'takes values of type float',
        ('(0.0, 1.5708)', '(0, 1.5708)'),
        outcome=ERROR,
    ),
    right('by odometry'),
    right(
        'without commands in its pauses',
        ('2 * [(0.0, 0.0)]', '[(0.0, 0.0)] + 2 * [None]'),
        ('5 * [(0.0, 0.0)]', '[(0.0, 0.0)] + 4 * [None]'),
        (
            '        v, w = self.plan.pop(0)\n',
            '        step = self.plan.pop(0)\n        if step is None:\n            return\n',
        ),
        ('msg.angular.z = v, w', 'msg.angular.z = step'),
    ),
    right('without a last turn', ('4 * (side + turn)', '(4 * (side + turn))[:-15]')),
    right('a loop with a rate, in a thread'),
]
