"""Answers to `evens`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

RUN = 'python3 nodes/evens.py > evens.log 2>&1 &\n'

ANSWERS = [
    wrong('in the notebook', 'A node of a notebook ends with the notebook.'),
    wrong('not started', 'No program of that name runs on this machine', (RUN, '')),
    wrong(
        'without the line with export',
        'it has none: domain 0',
        (RUN, f'env -u ROS_DOMAIN_ID {RUN}'),
    ),
    wrong(
        'changed while it runs',
        'A program keeps the code with which it was started.',
        (RUN, f'{RUN}touch -d "5 seconds" nodes/evens.py\n'),
    ),
    wrong(
        'does not spin', 'If it ends at once, read there why.', ('rclpy.spin(Evens())', 'Evens()')
    ),
    wrong(
        'another node name',
        'The name of the node is what super().__init__() gets.',
        ("__init__('evens')", "__init__('even')"),
    ),
    wrong('another file', 'the file nodes/even.py', ('> nodes/evens.py', '> nodes/even.py')),
    wrong(
        'another topic',
        'names must be equal to the last letter',
        ("Int16, 'evens'", "Int16, 'event'"),
    ),
    wrong(
        'publishes twice',
        'A message is answered more than once.',
        (
            '        self.publisher.publish(even)\n',
            '        self.publisher.publish(even)\n        self.publisher.publish(even)\n',
        ),
    ),
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
    right('functions'),
    right('a list and a timer'),
    right('in the folder', (RUN, f'cd nodes\n{RUN.replace("nodes/", "")}')),
    right(
        'an executor with many threads',
        ('rclpy.spin(Evens())', 'rclpy.spin(Evens(), executor=MultiThreadedExecutor())'),
        (
            'import ExternalShutdownException',
            'import ExternalShutdownException, MultiThreadedExecutor',
        ),
    ),
]
