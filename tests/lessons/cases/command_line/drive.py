"""Answers to `drive`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'fields without their message',
        'Fields that are messages themselves take braces of their own.',
        ('linear: {x: 0.2}, angular: {z: 0.5}', 'x: 0.2, z: 0.5'),
    ),
    wrong('a little too slow', 'Use --rate 10.', ('--rate 10', '--rate 8')),
    wrong('a little too fast', 'Use --rate 10.', ('--rate 10', '--rate 12.5')),
    wrong('too slow, in the background', 'Use --rate 10.'),
    wrong('one more', '6 of them', ('--times 5', '--times 6')),
    wrong('another speed', 'linear.x = 0.25', ('0.2', '0.25')),
    wrong('the last one is another', 'all fields are 0'),
    wrong('another topic, too', 'messages on /wheels as well'),
    wrong('other topic', 'is not /cmd_vel', ('--times 5', '--once'), ('/cmd_vel', '/cmdvel -w 0')),
    right('in lines, all fields'),
    right(
        'in the background',
        (
            '    "{linear: {x: 0.2}, angular: {z: 0.5}}"\n',
            '    "{linear: {x: 0.2}, angular: {z: 0.5}}" &\n',
        ),
    ),
    right('as in a terminal', ('%', '!')),
    right('YAML in lines, fields in another order'),
    right('twice'),
    right('after one message'),
    right('a program', run='process'),
    right('a node'),
]
