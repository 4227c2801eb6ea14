"""Answers to `ones`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'raised before the check, once',
        'RuntimeError: the first time',
        (
            '        msg = Int16()\n',
            "        if not hasattr(self, 'late'):\n            self.late = True\n"
            "            raise RuntimeError('the first time')\n        msg = Int16()\n",
        ),
        ('lab.spin(Ones())', "lab.spin(Ones())\nlab.wait_until(lambda: hasattr(ones, 'late'))"),
        outcome=ERROR,
    ),
    wrong('capital letter', 'Capital and small letters differ in names'),
    wrong(
        'in the namespace of the node',
        'it lies in another namespace',
        ("'ones', 10", "'~/ones', 10"),
    ),
    wrong('wrong type', 'A topic carries one type of message.', ('Int16', 'Int32')),
    wrong(
        'publishes a bare number',
        'publish() takes a message of the type that the publisher was made for, Int16',
        ('publish(msg)', 'publish(1)'),
        outcome=ERROR,
    ),
    wrong(
        'a text for a number',
        'takes values of type int',
        ('msg.data = 1', "msg.data = '1'"),
        outcome=ERROR,
    ),
    wrong(
        'counts',
        'The value changes from message to message.',
        ("super().__init__('ones')\n", "super().__init__('ones')\n        self.n = 0\n"),
        ('msg.data = 1', 'self.n += 1\n        msg.data = self.n'),
    ),
    wrong('self forgotten', 'Ones has nothing called publisher', outcome=ERROR),
    wrong(
        'rate for period',
        'A rate in Hz and a period in seconds were mixed up',
        ('create_timer(0.1,', 'create_timer(10,'),
    ),
    wrong(
        'a thread says 2 now and then',
        'Without those with another value the rate is right.',
        (
            'self.on_timer)\n\n',
            'self.on_timer)\n'
            '        threading.Thread(target=self.at_times, daemon=True).start()\n\n'
            '    def at_times(self):\n        while rclpy.ok():\n            time.sleep(1.6)\n'
            '            self.publisher.publish(Int16(data=2))\n\n',
        ),
        ('from rclpy.node', 'import threading\nimport time\n\nimport rclpy\nfrom rclpy.node'),
    ),
    wrong('ten times too fast', 'times too fast', ('create_timer(0.1,', 'create_timer(0.01,')),
    wrong('a fifth too slow', '1.25 times too slow', ('create_timer(0.1,', 'create_timer(0.125,')),
    wrong(
        'a quarter too fast', '1.25 times too fast', ('create_timer(0.1,', 'create_timer(0.08,')
    ),
    wrong(
        'a thread that sleeps 3 % too long',
        '1.03 times too slow',
        ('time.sleep(0.1)', 'time.sleep(0.103)'),
        of='a loop that sleeps, in a thread',
    ),
    wrong(
        'a thread that ends after 20 s',
        'They stop coming.',
        (
            '    while rclpy.ok():\n',
            '    end = time.monotonic() + 20\n    while time.monotonic() < end:\n',
        ),
        of='a loop that sleeps, in a thread',
    ),
    wrong(
        'stops after fifteen seconds',
        'They stop coming.',
        ("super().__init__('ones')\n", "super().__init__('ones')\n        self.n = 0\n"),
        (
            '        msg = Int16()\n',
            '        self.n += 1\n        if self.n == 150:\n'
            '            self.timer.cancel()\n        msg = Int16()\n',
        ),
    ),
    wrong(
        'ends after ten',
        'They stop coming.',
        ("super().__init__('ones')\n", "super().__init__('ones')\n        self.n = 0\n"),
        (
            '        msg = Int16()\n',
            '        self.n += 1\n        if self.n == 10:\n'
            '            self.timer.cancel()\n        msg = Int16()\n',
        ),
    ),
    wrong(
        'ten at once, each second',
        'They come in bursts, or with pauses.',
        ('create_timer(0.1,', 'create_timer(1.0,'),
        (
            '        self.publisher.publish(msg)\n',
            '        for _ in range(10):\n            self.publisher.publish(msg)\n',
        ),
    ),
    wrong('publishes twice', 'Twice as many messages come as were asked for'),
    wrong(
        'right first, wrong later',
        'that were right',
        ("super().__init__('ones')\n", "super().__init__('ones')\n        self.n = 0\n"),
        ('msg.data = 1', 'self.n += 1\n        msg.data = 1 if self.n < 100 else 0'),
    ),
    wrong('a single message', 'The node has no timer'),
    wrong('not spun', 'Hand the node over: lab.spin(node)'),
    wrong(
        'a quarter too fast, in a process of its own',
        'times too fast',
        ('create_timer(0.1,', 'create_timer(0.08,'),
        run='process',
    ),
    right('functions'),
    right('a loop with a rate, in a thread'),
    right('a loop that sleeps, in a thread'),
    right(
        'a fast timer, and every tenth call counts',
        ("super().__init__('ones')\n", "super().__init__('ones')\n        self.calls = 0\n"),
        ('create_timer(0.1,', 'create_timer(0.01,'),
        (
            '        msg = Int16()\n',
            '        self.calls += 1\n        if self.calls % 10:\n            return\n'
            '        msg = Int16()\n',
        ),
    ),
    wrong(
        'five at once at its beginning',
        'They come in bursts',
        (
            'create_timer(0.1, self.on_timer)\n',
            'create_timer(0.1, self.on_timer)\n        for _ in range(5):\n'
            '            self.on_timer()\n',
        ),
    ),
    wrong(
        'another number at its beginning',
        'before the check',
        (
            'create_timer(0.1, self.on_timer)\n',
            'create_timer(0.1, self.on_timer)\n        self.publisher.publish(Int16())\n',
        ),
    ),
    right(
        'the first one at once',
        (
            'create_timer(0.1, self.on_timer)\n',
            'create_timer(0.1, self.on_timer)\n        self.on_timer()\n',
        ),
    ),
    wrong(
        'ten a second, but not evenly',
        'They come in bursts, or with pauses.',
        ("super().__init__('ones')\n", "super().__init__('ones')\n        self.calls = 0\n"),
        ('create_timer(0.1,', 'create_timer(0.02,'),
        (
            '        msg = Int16()\n',
            '        self.calls += 1\n        if self.calls % 10 not in (0, 7):\n'
            '            return\n        msg = Int16()\n',
        ),
    ),
    right(
        'a fast timer that looks at the clock',
        (
            "super().__init__('ones')\n",
            "super().__init__('ones')\n        self.due = self.get_clock().now()\n",
        ),
        ('create_timer(0.1,', 'create_timer(0.01,'),
        (
            '        msg = Int16()\n',
            '        if self.get_clock().now() < self.due:\n            return\n'
            '        self.due += Duration(seconds=0.1)\n        msg = Int16()\n',
        ),
        ('from rclpy.node', 'from rclpy.duration import Duration\nfrom rclpy.node'),
    ),
    right(
        "a fast timer that looks at the computer's clock",
        (
            "super().__init__('ones')\n",
            "super().__init__('ones')\n        self.due = time.monotonic()\n",
        ),
        ('create_timer(0.1,', 'create_timer(0.02,'),
        (
            '        msg = Int16()\n',
            '        if time.monotonic() < self.due:\n            return\n'
            '        self.due += 0.1\n        msg = Int16()\n',
        ),
        ('from rclpy.node', 'import time\n\nfrom rclpy.node'),
    ),
    right(
        'kept for those who come late',
        (
            "create_publisher(Int16, 'ones', 10)",
            'create_publisher(\n'
            "            Int16, 'ones', QoSProfile(depth=1, "
            'durability=DurabilityPolicy.TRANSIENT_LOCAL)\n        )',
        ),
        (
            'from rclpy.node import Node\n',
            'from rclpy.node import Node\nfrom rclpy.qos import DurabilityPolicy, QoSProfile\n',
        ),
    ),
    right('a name that the lesson has used, and a name that is remapped'),
    right('an executor of its own, in a thread'),
    right('on the command line'),
]
