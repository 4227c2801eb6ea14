"""Answers to `four_a_second`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'rate for period', 'A rate in Hz and a period in seconds were mixed up', ('0.25', '4.0')
    ),
    wrong(
        'wrong type',
        'A topic carries one type of message.',
        ('String', 'Int16'),
        ("'I am here'", '7'),
    ),
    wrong('off by ten', 'times too fast', ('0.25', '0.025')),
    wrong('half a second', 'times too slow', ('0.25', '0.5')),
    wrong('five a second', '1.25 times too fast', ('0.25', '0.2')),
    wrong('a third of a second', '1.2 times too slow', ('0.25', '0.3')),
    wrong('a little too fast', '1.04 times too fast', ('0.25', '0.24')),
    wrong('publishes twice', 'is publish() called twice'),
    wrong(
        'four at once, once a second',
        'They come in bursts, or with pauses.',
        ('0.25', '1.0'),
        (
            "        self.publisher.publish(String(data='I am here'))\n",
            '        for _ in range(4):\n'
            "            self.publisher.publish(String(data='I am here'))\n",
        ),
    ),
    wrong(
        'stops after a minute',
        'They stop coming.',
        (
            "        super().__init__('beacon')\n",
            "        super().__init__('beacon')\n        self.calls = 0\n",
        ),
        (
            "        self.publisher.publish(String(data='I am here'))\n",
            '        self.calls += 1\n        if self.calls <= 80:\n'
            "            self.publisher.publish(String(data='I am here'))\n",
        ),
    ),
    wrong(
        'ends after forty',
        'They stop coming.',
        (
            "        super().__init__('beacon')\n",
            "        super().__init__('beacon')\n        self.calls = 0\n",
        ),
        (
            "        self.publisher.publish(String(data='I am here'))\n",
            "        self.publisher.publish(String(data='I am here'))\n"
            '        self.calls += 1\n        if self.calls == 40:\n'
            '            self.timer.cancel()\n',
        ),
    ),
    wrong(
        'right at first, slower later',
        ' on /beacon',
        (
            "        super().__init__('beacon')\n",
            "        super().__init__('beacon')\n        self.calls = 0\n",
        ),
        (
            "        self.publisher.publish(String(data='I am here'))\n",
            '        self.calls += 1\n        if self.calls < 60 or self.calls % 2:\n'
            "            self.publisher.publish(String(data='I am here'))\n",
        ),
    ),
    wrong(
        'a thread that sleeps too long',
        'times too slow',
        ('0.25', '0.3'),
        of='a loop that sleeps, in a thread',
    ),
    wrong('another topic', 'A slip of the pen'),
    wrong('not spun', 'Hand the node over'),
    wrong(
        'decimal comma',
        'the pair of 0 and 25',
        ('0.25', '0,25'),
        outcome=ERROR,
        refused='A formatter writes a space after the comma.',
    ),
    wrong('two copies running', 'Two copies of the node run at once', run='two copies'),
    right('a fraction', ('0.25', '1 / 4')),
    right('a loop with a rate, in a thread'),
    right('a loop that sleeps, in a thread'),
    right(
        'a fast timer, and every fifth call counts',
        (
            "        super().__init__('beacon')\n",
            "        super().__init__('beacon')\n        self.calls = 0\n",
        ),
        ('0.25', '0.05'),
        (
            "        self.publisher.publish(String(data='I am here'))\n",
            '        self.calls += 1\n        if self.calls % 5 == 0:\n'
            "            self.publisher.publish(String(data='I am here'))\n",
        ),
    ),
    right(
        'a fast timer that looks at the clock',
        (
            "        super().__init__('beacon')\n",
            "        super().__init__('beacon')\n        self.due = self.get_clock().now()\n",
        ),
        ('0.25  #', '0.05  #'),
        (
            "        self.publisher.publish(String(data='I am here'))\n",
            '        if self.get_clock().now() >= self.due:\n'
            '            self.due += Duration(seconds=0.25)\n'
            "            self.publisher.publish(String(data='I am here'))\n",
        ),
        ('from rclpy.node', 'from rclpy.duration import Duration\nfrom rclpy.node'),
    ),
    right(
        "a fast timer that looks at the computer's clock",
        (
            "        super().__init__('beacon')\n",
            "        super().__init__('beacon')\n        self.due = time.monotonic()\n",
        ),
        ('0.25  #', '0.05  #'),
        (
            "        self.publisher.publish(String(data='I am here'))\n",
            '        if time.monotonic() >= self.due:\n            self.due += 0.25\n'
            "            self.publisher.publish(String(data='I am here'))\n",
        ),
        ('from rclpy.node', 'import time\n\nfrom rclpy.node'),
    ),
    right(
        'kept for those who come late, by a node with the name of another one',
        ("__init__('beacon')", "__init__('talker')"),
        ("String, 'beacon', 10", "String, 'beacon', latched"),
        (
            '\n\nclass',
            '\n'
            'latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n'
            '\n\nclass',
        ),
        (
            'from rclpy.node import Node\n',
            'from rclpy.node import Node\nfrom rclpy.qos import DurabilityPolicy, QoSProfile\n',
        ),
    ),
    right('in a namespace, remapped, with an executor of its own'),
    right('a command'),
]
