"""Answers to `odds`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong('no space', 'a colon is followed by a space', (': 1', ':1'), of='only the first'),
    wrong(
        'no quotation marks',
        'Quotation marks around the YAML hold its words together.',
        ('"', ''),
        of='only the first',
    ),
    wrong(
        'all in one message',
        'each number needs a message of its own',
        ('1}', '[1, 3, 5]}'),
        of='only the first',
    ),
    wrong(
        'without --once',
        'Without --once a command goes on publishing',
        ('--once', '--rate 20 --timeout 0.3'),
        of='only the first',
    ),
    wrong(
        'capital letter',
        'Capital and small letters differ in names: /Odds and /odds',
        ('--once /odds', '--once -w 0 /Odds'),
    ),
    wrong(
        'another name', '/odd is not /odds', ('--once /odds', '-1 -w 0 /odd'), of='only the first'
    ),
    wrong(
        'text for a number',
        'A topic carries one type of message.',
        ('Int16', 'String'),
        ('1}', "'1'}"),
        of='only the first',
    ),
    wrong('type cut short', 'a type has three parts', ('std_msgs/msg/', ''), of='only the first'),
    wrong('a word', 'written in digits', ('1}', 'one}'), of='only the first'),
    wrong('two slashes', 'One slash at the beginning', ('/odds', '//odds'), of='only the first'),
    wrong('only the first', 'Still missing: 3, 5. Next: Go on with 3, then 5.'),
    wrong(
        'one more',
        'Other numbers came as well',
        (
            '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 5}"\n',
            '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 5}"\n'
            '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 7}"\n',
        ),
    ),
    wrong('all numbers', 'Other numbers came as well'),
    wrong(
        'another topic, too',
        'messages on /odd_numbers as well',
        (
            '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 5}"\n',
            '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 5}"\n'
            '%ros2 topic pub --once -w 0 /odd_numbers std_msgs/msg/Int16 "{data: 1}"\n',
        ),
    ),
    wrong('a loop without an end', 'messages that go on coming'),
    right('short names, other quotation marks'),
    right(
        'also with the command of the shell',
        (
            '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 1}"\n',
            '!ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 1}"\n',
        ),
    ),
    right(
        'after a wrong one',
        (
            '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 1}"\n',
            '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 8}"\n'
            '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 1}"\n',
        ),
    ),
    right('twice'),
    right(
        'the first one twice',
        (
            '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 1}"\n',
            '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 1}"\n'
            '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 1}"\n',
        ),
    ),
    right('after another type, which is refused'),
    right('in the background'),
    right('a node'),
]
