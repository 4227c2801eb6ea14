"""Answers to `count_up`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

NUMBERS = 'The count does not begin with 1, or does not grow by 2.'
ANSWERS = [
    wrong('starts at 0', NUMBERS, ('self.number = 1', 'self.number = 0')),
    wrong(
        'starts at 3',
        NUMBERS,
        ('self.number = 1', 'self.number = 3'),
    ),
    wrong(
        'never counts',
        NUMBERS,
        ('self.number += 2', 'number = self.number + 2'),
        refused='The variable is never used.',
    ),
    wrong(
        'counts by 4',
        NUMBERS,
        ('self.number += 2', 'self.number += 4'),
    ),
    wrong(
        'starts over',
        NUMBERS,
        ('self.number += 2', 'self.number = (self.number + 2) % 4'),
    ),
    wrong('rate for period', 'its period is 10 s', ('create_timer(0.1,', 'create_timer(10,')),
    wrong('private name', 'it lies in another namespace', ("'demo_odds'", "'~/demo_odds'")),
    wrong('another topic', 'The names differ in an underscore'),
    wrong(
        'quite another name',
        'The node works with a topic of another name',
        ("'demo_odds'", "'numbers'"),
    ),
    wrong('wrong type', 'A topic carries one type of message.', ('Int16', 'Int32')),
    wrong(
        'forgot to publish',
        'publish() is not called there',
        ('self.publisher.publish(msg)', 'pass'),
    ),
    wrong(
        'publishes once',
        'publish() ran once at most',
        ('        self.timer = self.create_timer(0.1, self.on_timer)\n', ''),
        ('self.number = 1\n', 'self.number = 1\n        self.on_timer()\n'),
    ),
    wrong(
        'not spun',
        'nothing runs its callbacks',
        ('lab.spin(OddPublisher())', 'node = OddPublisher()'),
    ),
    wrong(
        'callback called',
        'Pass the name alone, without brackets',
        ('self.on_timer)', 'self.on_timer())'),
        ('        self.number = 1\n', ''),
        (
            "super().__init__('odd_publisher')\n",
            "super().__init__('odd_publisher')\n        self.number = 1\n",
        ),
        outcome=ERROR,
    ),
    wrong(
        'publisher made in the callback',
        'makes a publisher again and again',
        (
            '        msg = Int16()\n',
            "        self.publisher = self.create_publisher(Int16, 'demo_odds', 10)\n"
            '        msg = Int16()\n',
        ),
    ),
    wrong(
        'another node on the same topic',
        '/copy/odd_publisher in this notebook',
        (
            'lab.spin(OddPublisher())\n',
            'lab.spin(OddPublisher())\n\n'
            "other = Node('odd_publisher', namespace='copy')\n"
            "again = other.create_publisher(Int16, '/demo_odds', 10)\n",
        ),
    ),
    wrong('two copies', 'Two copies of the node run at once', run='two copies'),
    wrong(
        'value of the wrong kind',
        'takes values of type int',
        ('msg.data = self.number', 'msg.data = str(self.number)'),
        outcome=ERROR,
    ),
    wrong(
        'publishes a number',
        'publish() takes a message of the type',
        ('self.publisher.publish(msg)', 'self.publisher.publish(msg.data)'),
        outcome=ERROR,
    ),
    wrong('another node name', 'a node called /odd_publisher'),
    right('functions and a thread'),
    right('loop with a rate'),
]
