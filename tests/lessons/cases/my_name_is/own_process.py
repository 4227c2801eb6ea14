"""Answers to `own_process`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'in the notebook',
        'lab.spin() runs a node in the process of this notebook.',
        ('rclpy.init()\nrclpy.spin(Opener())', 'lab.spin(Opener())'),
        of='a script, started by hand',
    ),
    wrong(
        'does not spin, started by subprocess', 'rclpy.spin(node) in the last line keeps it going'
    ),
    wrong(
        'ends, a while after its node',
        'A program ends when its last line is done',
        (
            'rclpy.spin(Opener())',
            'import time\nnode = Opener()\ntime.sleep(1.0)\n'
            'node.destroy_node()\nrclpy.shutdown()\ntime.sleep(8.0)',
        ),
    ),
    wrong(
        'an import is missing',
        "its last line is: NameError: name 'Node' is not defined",
        ('from rclpy.node import Node\n', ''),
    ),
    wrong(
        'space missing',
        'A space is missing at the end of the text.',
        ("'My name is '", "'My name is'"),
        of='a script, started by hand',
        run='process',
    ),
    wrong(
        'two copies running',
        'Two copies of the node run at once',
        ('rclpy.spin(', 'copy = Opener()\nrclpy.spin('),
        of='a script, started by hand',
        run='process',
    ),
    wrong(
        'three times in two seconds',
        'times too slow',
        ('create_timer(0.5,', 'create_timer(0.6,'),
        of='a script, started by hand',
        run='process',
    ),
    wrong(
        'every 2 s',
        'A rate in Hz and a period in seconds were mixed up',
        ('create_timer(0.5,', 'create_timer(2,'),
        of='a script, started by hand',
        run='process',
    ),
    wrong(
        'ends after fifty',
        'They stop coming.',
        ("super().__init__('opener')\n", "super().__init__('opener')\n        self.n = 0\n"),
        (
            "        self.publisher.publish(String(data='My name is '))\n",
            '        self.n += 1\n        if self.n < 50:\n'
            "            self.publisher.publish(String(data='My name is '))\n",
        ),
        of='a script, started by hand',
        run='process',
    ),
    wrong(
        'twice each time',
        'Twice as many messages come as were asked for',
        (
            "        self.publisher.publish(String(data='My name is '))\n",
            "        self.publisher.publish(String(data='My name is '))\n"
            "        self.publisher.publish(String(data='My name is '))\n",
        ),
        of='a script, started by hand',
        run='process',
    ),
    wrong(
        'another callback',
        'publish() was called too early, once, or never',
        ('create_timer(0.5, self.on_timer)', 'create_timer(0.5, print)'),
        of='a script, started by hand',
        run='process',
    ),
    right('a script, started by hand', run='process'),
    right('a loop', run='process'),
    right(
        'a fast timer, and every fifth call counts',
        ("super().__init__('opener')\n", "super().__init__('thermometer')\n        self.n = 0\n"),
        ('create_timer(0.5,', 'create_timer(0.1,'),
        (
            "        self.publisher.publish(String(data='My name is '))\n",
            '        self.n += 1\n        if self.n % 5 == 0:\n'
            "            self.publisher.publish(String(data='My name is '))\n",
        ),
        of='a script, started by hand',
        run='process',
    ),
    right(
        'an executor with many threads',
        ('rclpy.spin(Opener())', 'rclpy.spin(Opener(), executor=MultiThreadedExecutor())'),
        ('from rclpy.node', 'from rclpy.executors import MultiThreadedExecutor\nfrom rclpy.node'),
        of='a script, started by hand',
        run='process',
    ),
    right('a clock in seconds, asked often', run='process'),
    right('started by subprocess', of='a script, started by hand', run='subprocess'),
    right('started by asyncio', of='a script, started by hand', run='asyncio'),
]
