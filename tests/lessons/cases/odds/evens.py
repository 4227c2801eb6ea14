"""Answers to `evens`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'counts by itself',
        'does not depend on the number that came',
        ("super().__init__('evens')\n", "super().__init__('evens')\n        self.n = 0\n"),
        ('even.data = msg.data + 1', 'self.n += 2\n        even.data = self.n'),
    ),
    wrong(
        'publishes where it listens',
        'The node hears what it says itself',
        ("Int16, 'evens', 10", "Int16, 'odds', 10"),
    ),
    wrong('another topic', 'names must be equal to the last letter'),
    wrong(
        'forgot to publish',
        'its callback did not publish',
        ('        self.publisher.publish(even)\n', ''),
    ),
    wrong(
        'no publisher',
        'create_publisher() for this topic has not been called',
        ("        self.publisher = self.create_publisher(Int16, 'evens', 10)\n", ''),
        ('        self.publisher.publish(even)\n', ''),
    ),
    wrong(
        'publisher made in the callback',
        'makes a publisher again and again',
        ("        self.publisher = self.create_publisher(Int16, 'evens', 10)\n", ''),
        ('self.publisher.pub', "self.create_publisher(Int16, 'evens', 10).pub"),
    ),
    wrong(
        'adds to the message',
        'A message object (Int16) is not the value in it.',
        ('msg.data + 1', 'msg + 1'),
        outcome=ERROR,
    ),
    wrong(
        'adds a float',
        'takes values of type int',
        ('msg.data + 1', 'msg.data + 1.0'),
        outcome=ERROR,
    ),
    wrong('callback called', 'A callback is passed, not called', outcome=ERROR),
    wrong(
        'blocks in the callback',
        'While a callback runs, no other one can',
        ('    def on_odd(self, msg):\n', '    def on_odd(self, msg):\n        sleep(3)\n'),
        ('from rclpy', 'from time import sleep\n\nfrom rclpy'),
    ),
    wrong('publishes twice', 'A message is answered more than once.'),
    wrong(
        'a message at its beginning',
        # Odd numbers may have come before the line that publishes.
        '1 more on /evens since /evens was made: data = 2',
        (
            "Int16, 'evens', 10)\n",
            "Int16, 'evens', 10)\n        self.publisher.publish(Int16(data=2))\n",
        ),
    ),
    wrong(
        'a message half a second after its beginning',
        '1 more on /evens since /evens was made: data = 2',
        (
            "Int16, 'evens', 10)\n",
            "Int16, 'evens', 10)\n        self.timer = self.create_timer(0.5, self.on_timer)\n",
        ),
        (
            '    def on_odd',
            '    def on_timer(self):\n        self.timer.cancel()\n'
            '        self.publisher.publish(Int16(data=2))\n\n    def on_odd',
        ),
    ),
    wrong(
        'passes on, and answers',
        'The input is published too',
        ('        even = Int16()', '        self.publisher.publish(msg)\n        even = Int16()'),
    ),
    wrong(
        'repeats its answer',
        'a timer or a loop publishes it',
        (
            "super().__init__('evens')\n",
            "super().__init__('evens')\n        self.even = Int16()\n"
            '        self.timer = self.create_timer(0.2, self.on_timer)\n',
        ),
        (
            '        even = Int16()\n        even.data = msg.data + 1\n'
            '        self.publisher.publish(even)\n',
            '        self.even.data = msg.data + 1\n\n    def on_timer(self):\n'
            '        self.publisher.publish(self.even)\n',
        ),
    ),
    wrong(
        'only the first time',
        'does not depend on the number that came',
        ("super().__init__('evens')\n", "super().__init__('evens')\n        self.even = None\n"),
        (
            '        even = Int16()\n        even.data = msg.data + 1\n'
            '        self.publisher.publish(even)\n',
            '        self.even = self.even or Int16(data=msg.data + 1)\n'
            '        self.publisher.publish(self.even)\n',
        ),
    ),
    wrong(
        'ends after five',
        # The five may be of the lesson's own nodes, before the check.
        'nothing on /evens',
        ("super().__init__('evens')\n", "super().__init__('evens')\n        self.count = 0\n"),
        (
            '        even = Int16()\n',
            '        self.count += 1\n        if self.count > 5:\n            return\n'
            '        even = Int16()\n',
        ),
    ),
    wrong(
        'answers another topic, too',
        'What comes on /ones is answered, too.',
        (
            "Int16, 'odds', self.on_odd, 10)\n",
            "Int16, 'odds', self.on_odd, 10)\n"
            "        self.create_subscription(Int16, 'ones', self.on_odd, 10)\n",
        ),
    ),
    wrong(
        'answers three seconds later',
        'The answers wait for a timer',
        (
            "super().__init__('evens')\n",
            "super().__init__('evens')\n        self.waiting = []\n"
            '        self.create_timer(3.0, self.on_timer)\n',
        ),
        (
            '        even = Int16()\n        even.data = msg.data + 1\n'
            '        self.publisher.publish(even)\n',
            '        self.waiting.append(msg.data)\n\n    def on_timer(self):\n'
            '        for number in self.waiting:\n'
            '            self.publisher.publish(Int16(data=number + 1))\n'
            '        self.waiting.clear()\n',
        ),
    ),
    wrong('wrong type', 'Use the same type on both sides', outcome=ERROR),
    wrong(
        'not the same again',
        'were answered correctly, the others were not',
        ("super().__init__('evens')\n", "super().__init__('evens')\n        self.last = None\n"),
        (
            '        even = Int16()\n',
            '        if msg.data == self.last:\n            return\n'
            '        self.last = msg.data\n        even = Int16()\n',
        ),
    ),
    wrong(
        'the largest and the smallest number left out',
        'were answered correctly, the others were not',
        (
            '        even = Int16()\n',
            '        if not -32767 < msg.data < 32765:\n            return\n'
            '        even = Int16()\n',
        ),
    ),
    right('functions'),
    right(
        'two steps with a topic of their own in between',
        (
            "super().__init__('evens')\n",
            "super().__init__('evens')\n"
            "        self.step = self.create_publisher(Int16, 'my_step', 10)\n"
            "        self.create_subscription(Int16, 'my_step', self.on_step, 10)\n",
        ),
        (
            '        even = Int16()\n',
            '        self.step.publish(msg)\n\n    def on_step(self, msg):\n'
            '        even = Int16()\n',
        ),
    ),
    right('a list and a timer'),
    right('a thread that takes from a queue'),
    right(
        'a name that the lesson has used',
        ("super().__init__('evens')", "super().__init__('announcer')"),
    ),
    right(
        'an executor of its own, in a thread',
        (
            'from rclpy.node',
            'import threading\n\nfrom rclpy.executors import MultiThreadedExecutor\n'
            'from rclpy.node',
        ),
        (
            'evens = lab.spin(Evens())\n',
            'executor = MultiThreadedExecutor()\nexecutor.add_node(Evens())\n'
            'threading.Thread(target=executor.spin, daemon=True).start()\n',
        ),
    ),
]
