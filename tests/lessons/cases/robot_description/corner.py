"""Answers to `corner`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'along the diagonal',
        'It was pushed beside its middle',
        (
            '            (msg.x - 0.4, msg.y, 1),\n            (1.24, msg.y, 1),\n'
            '            (0.9, msg.y, -1),\n            (1.36, msg.y - 0.45, 1),\n'
            '            (1.36, 1.24, 1),\n',
            '            (msg.x - 0.3, msg.y - 0.3, 1),\n            (1.3, 1.3, 1),\n',
        ),
    ),
    wrong(
        'beside its middle',
        'It was pushed beside its middle',
        ('(msg.x - 0.4, msg.y, 1)', '(msg.x - 0.4, msg.y - 0.09, 1)'),
        ('(1.24, msg.y, 1)', '(1.24, msg.y - 0.09, 1)'),
    ),
    wrong(
        'a crawl',
        'it still moves',
        ('way * 0.2', 'way * 0.05'),
    ),
    wrong(
        'forgets to stop',
        'leaves it driving',
        (
            '            self.points.pop(0)\n',
            '            self.points.pop(0)\n            if not self.points:\n'
            '                return\n',
        ),
    ),
    wrong(
        'says stop for ever',
        'It stands, and still publishes.',
        (
            '        if not self.points:\n            return\n',
            "        if not self.points:\n            if hasattr(self, 'drove'):\n"
            '                self.publisher.publish(Twist())\n            return\n'
            '        self.drove = True\n',
        ),
    ),
    wrong(
        'one crate and no more',
        'Something is used up by the first drive',
        (
            'def on_crate(self, msg):\n',
            'def on_crate(self, msg):\n'
            "        if self.__dict__.setdefault('used', msg) is not msg:"
            '\n            return\n',
        ),
    ),
    wrong(
        'waits a second',
        'Something waits before the drive begins',
        (
            '        if not self.points:\n            return\n',
            '        if not self.points:\n            self.waits = 10\n            return\n'
            '        if self.waits:\n            self.waits -= 1\n            return\n',
        ),
    ),
    wrong(
        'drives all the time',
        'It publishes without being asked to.',
        ('self.points = []', 'self.points = [(-1.0, -1.0, 1)]'),
    ),
    wrong(
        'degrees for radians',
        'Its angles are degrees',
        ('max(-1.5, min(1.5, 2 * error))', 'math.degrees(error)'),
    ),
    wrong(
        'an int in a float field',
        'takes values of type float',
        ('way * 0.2', 'way'),
        outcome=ERROR,
    ),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    right(
        'along y first',
        (
            '            (msg.x - 0.4, msg.y, 1),\n            (1.24, msg.y, 1),\n'
            '            (0.9, msg.y, -1),\n            (1.36, msg.y - 0.45, 1),\n'
            '            (1.36, 1.24, 1),\n',
            '            (msg.x, msg.y - 0.4, 1),\n            (msg.x, 1.24, 1),\n'
            '            (msg.x, 0.9, -1),\n            (msg.x - 0.45, 1.36, 1),\n'
            '            (1.24, 1.36, 1),\n',
        ),
    ),
    right('slower', ('way * 0.2', 'way * 0.15')),
    right('twenty commands a second', ('create_timer(0.1,', 'create_timer(0.05,')),
    right(
        'rests at each point',
        (
            '            self.points.pop(0)\n',
            '            self.points.pop(0)\n            self.rests = 5\n',
        ),
        (
            '        x, y, way = self.points[0]\n',
            "        if self.__dict__.get('rests'):\n            self.rests -= 1\n"
            '            self.publisher.publish(Twist())\n            return\n'
            '        x, y, way = self.points[0]\n',
        ),
    ),
]
