"""Answers to `bot`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'at most what the robot can do',
        'linear.x',
        ('-self.x', 'max(-0.22, min(0.22, -self.x))'),
    ),
    wrong(
        'a gain that is nearly right',
        'This is 1.0001 * x',
        ('= -self.x', '= -1.0001 * self.x'),
    ),
    wrong(
        'reads Twist instead of Odometry',
        'subscription to /odom',
        ("Odometry, 'odom'", "Twist, 'cmd_vel'"),
        ('msg.pose.pose.position.x', 'msg.linear.x'),
    ),
    wrong(
        'forgets to stop',
        'leaves it driving',
        ('self.steps = 21', 'self.steps = 20'),
        ('self.steps > 0:', 'True:'),
    ),
    wrong(
        'controls inside the callback',
        'the sensor sets the rate',
        ('= self.create_timer(0.1, self.on_timer)', '= None'),
        ('position.x\n', 'position.x\n        self.on_timer()\n'),
    ),
    wrong(
        'the first time only',
        'Something is used up by the first drive',
        ('        self.publisher =', '        self.used = False\n        self.publisher ='),
        (
            '        self.steps = 21\n',
            '        if not self.used:\n            self.used = True\n'
            '            self.steps = 21\n',
        ),
    ),
    wrong(
        'drives all the time',
        'publishes without being asked to',
        (
            '        if self.steps == 0:\n            return\n        self.steps -= 1\n',
            '        self.steps = 21\n',
        ),
    ),
    wrong('a step too few', 'not to the right number', ('steps = 21', 'steps = 20')),
    wrong(
        'twelve and a half commands a second',
        'a command every 0.08 s (12.5 Hz)',
        ('create_timer(0.1,', 'create_timer(0.08,'),
    ),
    wrong('a period of 0', 'A timer has no period', ('create_timer(0.1,', 'create_timer(0.0,')),
    wrong(
        'all at once',
        'A loop publishes them without a pause',
        ('= self.create_timer(0.1, self.on_timer)', '= None'),
        (
            '        self.steps = 21\n',
            '        self.steps = 21\n        while self.steps:\n            self.on_timer()\n',
        ),
    ),
    wrong('publishes twice', 'is publish() called twice'),
    wrong(
        'the place at the start',
        'it stays as it was at the start',
        ('        self.x = 0.0\n', '        self.x = self.start = 0.0\n'),
        ('        self.steps = 21\n', '        self.steps = 21\n        self.start = self.x\n'),
        ('= -self.x', '= -self.start'),
    ),
    wrong(
        'says stop for ever',
        'no command before the sign to start',
        (
            '        if self.steps == 0:\n            return\n        self.steps -= 1\n',
            '        if self.steps == 0:\n            self.publisher.publish(Twist())\n'
            '            return\n        self.steps -= 1\n',
        ),
    ),
    wrong(
        'says stop three times',
        'It stands, and still publishes.',
        ('self.steps = 21', 'self.steps = 23'),
        ('if self.steps > 0:\n            msg', 'if self.steps > 2:\n            msg'),
    ),
    wrong('an older node of another name', 'Each of them drives the robot'),
    wrong(
        'an int in a float field',
        'takes values of type float',
        ('= -self.x', '= -int(10 * self.x)'),
        outcome=ERROR,
    ),
    wrong(
        'publishes when it is made, and not at the sign',
        'does not start anything',
        ('        self.steps = 21\n', '        pass\n'),
        (
            '        self.x = 0.0\n',
            '        self.x = 0.0\n        self.steps = 1\n        self.on_timer()\n',
        ),
    ),
    wrong(
        'waits in the callback',
        'While a callback runs, no other one can',
        ('        self.steps = 21\n', '        import time\n\n        time.sleep(3)\n'),
    ),
    wrong(
        'two drives and no more',
        'drives after 2 of them, and nothing after the next one',
        (
            '        self.steps = 21\n',
            "        self.count = getattr(self, 'count', 0) + 1\n"
            '        if self.count <= 2:\n            self.steps = 21\n',
        ),
    ),
    right('a loop with a rate, in a thread'),
    right(
        'a thread that sleeps',
        ('import threading\n', 'import threading\nimport time\n'),
        ('        rate = node.create_rate(10)\n', ''),
        ('rate.sleep()', 'time.sleep(0.1)'),
        of='a loop with a rate, in a thread',
    ),
    right(
        'each tenth call of a fast timer',
        ('create_timer(0.1,', 'create_timer(0.01,'),
        ('        self.steps = 0\n', '        self.steps = self.calls = 0\n'),
        (
            '    def on_timer(self):\n        if self.steps == 0:\n',
            '    def on_timer(self):\n        self.calls += 1\n'
            '        if self.steps == 0 or self.calls % 10:\n',
        ),
    ),
    right(
        'a fast timer that looks at the clock',
        ('create_timer(0.1,', 'create_timer(0.005,'),
        ('        self.steps = 0\n', '        self.steps = self.due = 0\n'),
        (
            '    def on_timer(self):\n        if self.steps == 0:\n            return\n',
            '    def on_timer(self):\n        now = self.get_clock().now().nanoseconds\n'
            '        if self.steps == 0 or now < self.due:\n            return\n'
            '        self.due = max(self.due, now - 10**7) + 10**8\n',
        ),
    ),
    right(
        "a fast timer that looks at the computer's clock",
        ('from geometry', '\nimport time\n\nfrom geometry'),
        ('create_timer(0.1,', 'create_timer(0.005,'),
        ('        self.steps = 0\n', '        self.steps = self.due = 0\n'),
        (
            '    def on_timer(self):\n        if self.steps == 0:\n            return\n',
            '    def on_timer(self):\n        now = time.monotonic()\n'
            '        if self.steps == 0 or now < self.due:\n            return\n'
            '        self.due = max(self.due, now - 0.05) + 0.1\n',
        ),
    ),
]
