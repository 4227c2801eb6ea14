"""Answers to `reach`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

KEEP = "        self.goal = self.seen_from('odom', msg)\n"

ANSWERS = [
    wrong(
        'forgets to stop',
        'leaves it driving',
        ('            self.goal = None\n', '            self.goal = None\n            return\n'),
    ),
    wrong(
        'the first time only',
        'Something is used up by the first drive',
        (KEEP, "        if not hasattr(self, 'used'):\n            self.used = True\n    " + KEEP),
    ),
    wrong(
        'eight commands a second',
        'a command every 0.125 s (8 Hz)',
        ('create_timer(0.1,', 'create_timer(0.125,'),
    ),
    wrong('too slow', 'after the message', ('= 0.2', '= 0.02')),
    wrong(
        'degrees for radians',
        'Its angles are degrees',
        ('1.5 * error', '1.5 * math.degrees(error)'),
    ),
    wrong(
        'away from it',
        'It drives past the goal, or elsewhere.',
        ('1.5 * error', '-1.5 * error'),
    ),
    wrong(
        'to the left all the time',
        'It drives past the goal, or elsewhere.',
        ('1.5 * error', '0.8'),
    ),
    wrong(
        'only frames of the body',
        'LookupException',
        (KEEP, "        msg.header.frame_id += '_link'\n" + KEEP),
        outcome=ERROR,
    ),
    wrong(
        'an int in a float field', 'takes values of type float', ('= 0.2', '= 1'), outcome=ERROR
    ),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    right(
        'rests on its way',
        (KEEP, KEEP + '        self.rests = 1\n'),
        (
            '        if math.hypot',
            '        if math.hypot(point.x, point.y) < 0.3 and self.rests:\n'
            '            self.rests = 0\n        elif math.hypot',
        ),
    ),
    right(
        'turns while it drives',
        ('            if abs(error) < 0.5:\n                msg', '            msg'),
        ('= 0.2', '= max(0.0, 0.2 * math.cos(error))'),
    ),
    right(
        'seen from base_link',
        ("'base_footprint'", "'base_link'"),
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
