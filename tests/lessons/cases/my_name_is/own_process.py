"""Answers to `own_process`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

RUN = 'python3 nodes/stage_one.py > stage_one.log 2>&1 &\n'
SAYS = "        self.publisher.publish(String(data='My name is '))\n"
# As if the file had been changed a while after the start.
LATER = 'touch -d "5 seconds" nodes/stage_one.py\n'

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
        (RUN, f'{RUN}{LATER}'),
    ),
    wrong(
        'does not spin',
        'If it ends at once, read there why.',
        ('rclpy.spin(StageOne())', 'StageOne()'),
    ),
    wrong(
        'no call of main()', 'If it ends at once, read there why.', ('\n    main()', '\n    pass')
    ),
    wrong(
        'an import is missing',
        'If it ends at once, read there why.',
        ('from rclpy.node import Node\n', ''),
    ),
    wrong(
        'another node name',
        'The name of the node is what super().__init__() gets.',
        ("'stage_one')", "'opener')"),
    ),
    wrong(
        'another file',
        'the file nodes/stage1.py',
        ('> nodes/stage_one.py', '> nodes/stage1.py'),
    ),
    wrong(
        'space missing',
        'A space is missing at the end of the text.',
        ("'My name is '", "'My name is'"),
    ),
    wrong(
        'three times in two seconds',
        'times too slow',
        ('create_timer(0.5,', 'create_timer(0.6,'),
    ),
    wrong(
        'every 2 s',
        'A rate in Hz and a period in seconds were mixed up',
        ('create_timer(0.5,', 'create_timer(2,'),
    ),
    wrong(
        'ends after fifty',
        'They stop coming.',
        ("'stage_one')\n", "'stage_one')\n        self.n = 0\n"),
        (SAYS, f'        self.n += 1\n        if self.n < 50:\n    {SAYS}'),
    ),
    wrong('a loop of thirty', 'They stop coming.'),
    wrong('twice each time', 'Twice as many messages come', (SAYS, SAYS + SAYS)),
    wrong(
        'another callback',
        'publish() was called too early, once, or never',
        ('create_timer(0.5, self.on_timer)', 'create_timer(0.5, print)'),
    ),
    wrong('another topic', '/incomplet is not /incomplete', ("'incomplete'", "'incomplet'")),
    right('a loop'),
    right('a clock in seconds, asked often'),
    right('in the folder', (RUN, f'cd nodes\n{RUN.replace("nodes/", "")}')),
    right(
        'a fast timer, and every fifth call counts',
        ("'stage_one')\n", "'stage_one')\n        self.n = 0\n"),
        ('create_timer(0.5,', 'create_timer(0.1,'),
        (SAYS, f'        self.n += 1\n        if self.n % 5 == 0:\n    {SAYS}'),
    ),
    right(
        'an executor with many threads',
        ('rclpy.spin(StageOne())', 'rclpy.spin(StageOne(), executor=MultiThreadedExecutor())'),
        (
            'import ExternalShutdownException',
            'import ExternalShutdownException, MultiThreadedExecutor',
        ),
    ),
]
