"""Answers to `every_two_seconds`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'a period of 40 s',
        'The timer has hardly called its callback, or not at all: its period is 40 s.',
        ('(2.0,', '(40.0,'),
    ),
    wrong(
        'on the topic of another exercise',
        'nothing of it is what this task asks for',
        ("'chatter'", "'door'"),
    ),
    wrong('capital letter', 'Capital and small letters differ in names'),
    wrong('another topic', 'names must be equal to the last letter'),
    wrong(
        'in the namespace of the node',
        'it lies in another namespace',
        ("'chatter'", "'~/chatter'"),
    ),
    wrong(
        'wrong type',
        'A topic carries one type of message.',
        ('String', 'Int16'),
        ("'Hello from the slow talker'", '7'),
    ),
    wrong(
        'forgot to publish',
        'publish() is not called there',
        ('        self.publisher.publish(msg)\n', ''),
    ),
    wrong(
        'publishes once',
        'publish() ran once at most',
        ('self.timer = self.create_timer(2.0, self.on_timer)', 'self.on_timer()'),
    ),
    wrong('callback called', 'Pass the name alone, without brackets', outcome=ERROR),
    wrong('not spun', 'nothing runs its callbacks'),
    wrong('every 3 seconds', '1.5 times too slow', ('2.0', '3.0')),
    wrong('every 5 seconds', '2.5 times too slow', ('2.0', '5.0')),
    wrong('a little too slow', '1.05 times too slow', ('2.0', '2.1')),
    wrong('publishes twice', 'is publish() called twice'),
    wrong(
        'ends after five',
        'They stop coming.',
        (
            "        super().__init__('slow_talker')\n",
            "        super().__init__('slow_talker')\n        self.calls = 0\n",
        ),
        (
            '        self.publisher.publish(msg)\n',
            '        self.calls += 1\n        if self.calls <= 5:\n'
            '            self.publisher.publish(msg)\n',
        ),
    ),
    wrong(
        'a thread that sleeps too long',
        'times too slow',
        ('sleep(2)', 'sleep(3)'),
        of='a loop that sleeps, in a thread',
    ),
    wrong(
        'an empty text later on',
        'is an empty text, though others had one',
        (
            "        super().__init__('slow_talker')\n",
            "        super().__init__('slow_talker')\n        self.calls = 0\n",
        ),
        (
            '        self.publisher.publish(msg)\n',
            '        self.calls += 1\n        if self.calls > 5:\n'
            "            msg.data = ''\n        self.publisher.publish(msg)\n",
        ),
    ),
    wrong(
        'a class, and no node of it',
        'Nothing runs before a node is made of it.',
        ('\n\nslow_talker = lab.spin(SlowTalker())\n', ''),
    ),
    wrong(
        'not set up',
        'super().__init__(...) has not been called',
        ("        super().__init__('slow_talker')\n", ''),
        outcome=ERROR,
    ),
    wrong('off by ten', 'times too fast', ('2.0', '0.2')),
    wrong('rate for period', 'A rate in Hz and a period in seconds were mixed up', ('2.0', '0.5')),
    wrong(
        'publisher made in the callback',
        'makes a publisher again and again',
        ("        self.publisher = self.create_publisher(String, 'chatter', 10)\n", ''),
        ('self.publisher.pub', "self.create_publisher(String, 'chatter', 10).pub"),
    ),
    wrong(
        'message never filled',
        'its field data is an empty text at first',
        ("        msg.data = 'Hello from the slow talker'\n", ''),
    ),
    wrong(
        'publishes a text',
        'publish() takes a message of the type',
        ('publish(msg)', 'publish(msg.data)'),
        outcome=ERROR,
    ),
    wrong('two copies running', 'Two copies of the node run at once', run='two copies'),
    right('functions'),
    right('a loop that sleeps, in a thread'),
    right(
        'a fast timer, and every fourth call counts',
        (
            "        super().__init__('slow_talker')\n",
            "        super().__init__('slow_talker')\n        self.calls = 0\n",
        ),
        ('2.0', '0.5'),
        (
            '        self.publisher.publish(msg)\n',
            '        self.calls += 1\n        if self.calls % 4 == 0:\n'
            '            self.publisher.publish(msg)\n',
        ),
    ),
    right(
        "a fast timer that looks at the computer's clock",
        (
            "        super().__init__('slow_talker')\n",
            "        super().__init__('slow_talker')\n        self.due = time.monotonic()\n",
        ),
        ('2.0', '0.05'),
        (
            '        self.publisher.publish(msg)\n',
            '        if time.monotonic() >= self.due:\n            self.due += 2.0\n'
            '            self.publisher.publish(msg)\n',
        ),
        ('from rclpy.node', 'import time\n\nfrom rclpy.node'),
    ),
    right(
        'a publisher that is made late, by a node with the name of another one',
        ("__init__('slow_talker')", "__init__('talker')"),
        ("self.publisher = self.create_publisher(String, 'chatter', 10)", 'self.publisher = None'),
        (
            '        msg = String()\n',
            '        if self.publisher is None:\n'
            "            self.publisher = self.create_publisher(String, 'chatter', 10)\n"
            '        msg = String()\n',
        ),
    ),
    right('a task of asyncio'),
    right('a command'),
]
