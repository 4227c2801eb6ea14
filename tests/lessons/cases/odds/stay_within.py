"""Answers to `stay_within`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'no limit',
        'The field data holds whole numbers from one limit to the other',
        ('        if self.number > 32767:\n            self.number = 1\n', ''),
        outcome=ERROR,
    ),
    wrong(
        'no limit, checked late',
        'The field data holds whole numbers from one limit to the other',
        ('        if self.number > 32767:\n            self.number = 1\n', ''),
        (
            'late_odds = lab.spin(LateOdds(first=32751))\n',
            'late_odds = lab.spin(LateOdds(first=32751))\n'
            'lab.wait_until(lambda: late_odds.number > 32767)\n',
        ),
        outcome=ERROR,
    ),
    wrong(
        'a quarter too fast', '1.25 times too fast', ('create_timer(0.1,', 'create_timer(0.08,')
    ),
    wrong(
        'too slow, and over when the check comes',
        'times too slow',
        (
            '        self.timer = self.create_timer(0.1, self.on_timer)\n',
            '        self.timer = self.create_timer(0.2, self.on_timer)\n',
        ),
        ('            self.number = 1\n', '            self.timer.cancel()\n'),
        (
            'late_odds = lab.spin(LateOdds(first=32751))\n',
            'late_odds = lab.spin(LateOdds(first=32751))\n'
            'lab.wait_until(lambda: late_odds.number > 32767)\n',
        ),
    ),
    wrong(
        'rate for period',
        'A rate in Hz and a period in seconds were mixed up',
        ('create_timer(0.1,', 'create_timer(10,'),
    ),
    wrong(
        'adds before it publishes',
        'The count does not begin with the number that LateOdds',
        (
            '        self.publisher.publish(Int16(data=self.number))\n        self.number += 2\n',
            '        self.number += 2\n',
        ),
        ('self.number = 1\n', 'self.number = 1\n        self.publisher.publish(M)\n'),
        ('publish(M)', 'publish(Int16(data=self.number))'),
    ),
    wrong(
        'starts over, and then stops',
        'The count starts over, and then it stops.',
        (
            '            self.number = 1\n',
            '            self.number = 1\n        if self.number == 9:\n'
            '            self.timer.cancel()\n',
        ),
    ),
    wrong('not spun', 'Hand the node over: lab.spin(node)'),
    wrong(
        'goes below zero, in a process of its own',
        'The count should not go below zero.',
        ('self.number = 1\n', 'self.number -= 65536\n'),
        run='process',
    ),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    right(
        'remainder',
        (
            '        if self.number > 32767:\n            self.number = 1\n',
            '        self.number %= 32768\n',
        ),
    ),
    right('stops', ('            self.number = 1\n', '            self.timer.cancel()\n')),
    right('functions, and 32765 is the last'),
    right('a loop that sleeps, in a thread, and ends'),
    right('a loop that sleeps, in a thread, and starts over'),
    right(
        'a fast timer, and every fifth call counts',
        ('        self.number = first\n', '        self.number = first\n        self.n = 0\n'),
        ('create_timer(0.1,', 'create_timer(0.02,'),
        (
            '    def on_timer(self):\n',
            '    def on_timer(self):\n        self.n += 1\n        if self.n % 5 != 1:\n'
            '            return\n',
        ),
    ),
    right(
        'the check comes when the count has ended',
        ('            self.number = 1\n', '            self.timer.cancel()\n'),
        (
            'late_odds = lab.spin(LateOdds(first=32751))\n',
            'late_odds = lab.spin(LateOdds(first=32751))\n'
            'lab.wait_until(lambda: late_odds.number > 32767)\n',
        ),
    ),
]
