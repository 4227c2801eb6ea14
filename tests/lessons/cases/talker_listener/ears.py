"""Answers to `ears`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

RUN = 'python3 nodes/ear.py --ros-args -r __node:='
LEFT = f'{RUN}left_ear > left_ear.log 2>&1 &\n'
RIGHT = f'{RUN}right_ear > right_ear.log 2>&1 &\n'
SAYS = "        self.publisher.publish(String(data=f'{self.get_name()}: a dog'))\n"
# As if the file had been changed a while after the start.
LATER = 'touch -d "5 seconds" nodes/ear.py\n'
TWICE = 'until [ $(ros2 node list | grep -c left_ear) -ge 2 ]; do :; done\n'

ANSWERS = [
    wrong('not started', 'No program of that name runs on this machine', (LEFT, ''), (RIGHT, '')),
    wrong('one terminal only', 'each time its node gets its name in the terminal', (RIGHT, '')),
    wrong(
        'no names in the terminals',
        'each time its node gets its name in the terminal',
        (' --ros-args -r __node:=left_ear', ''),
        (' --ros-args -r __node:=right_ear', ''),
    ),
    wrong(
        'in another domain',
        'it runs with ROS_DOMAIN_ID=220',
        (RIGHT, f'ROS_DOMAIN_ID=220 {RIGHT}'),
    ),
    wrong(
        'without the line with export',
        'it has none: domain 0',
        (LEFT, f'env -u ROS_DOMAIN_ID {LEFT}'),
    ),
    wrong('two left ears', '2 nodes of the name /left_ear', (LEFT, f'{LEFT}{LEFT}{TWICE}')),
    wrong(
        'changed while it runs',
        'A program keeps the code with which it was started.',
        (RIGHT, f'{RIGHT}{LATER}'),
    ),
    wrong('in the notebook', 'A node of a notebook ends with the notebook.'),
    wrong(
        'one program makes both',
        'Each of them is to be a program of its own.',
        ('__init__(self)', '__init__(self, name)'),
        ("__init__('ear')", '__init__(name)'),
        (
            '        rclpy.spin(Ear())\n',
            '        executor = rclpy.get_global_executor()\n'
            "        for name in ('left_ear', 'right_ear'):\n"
            '            executor.add_node(Ear(name))\n'
            '        executor.spin()\n',
        ),
        (LEFT, 'python3 nodes/ear.py > ears.log 2>&1 &\n'),
        (RIGHT, ''),
    ),
    wrong(
        'no call of main()', 'If it ends at once, read there why.', ('\n    main()', '\n    pass')
    ),
    wrong('does not spin', 'If it ends at once, read there why.', ('rclpy.spin(Ear())', 'Ear()')),
    wrong(
        'sleeps',
        '0 of 2 publishers with this rate',
        ('import rclpy\n', 'import time\n\nimport rclpy\n'),
        ('rclpy.spin(Ear())', 'ear = Ear(); time.sleep(1000)'),
    ),
    wrong(
        'no node',
        'main() does not make a node, or waits before that.',
        ('import rclpy\n', 'import time\n\nimport rclpy\n'),
        ('rclpy.spin(Ear())', 'time.sleep(1000)'),
    ),
    wrong('another file', 'the file nodes/ears.py', ('> nodes/ear.py', '> nodes/ears.py')),
    wrong('beside the folder', 'the file ear.py', ('> nodes/ear.py', '> ear.py')),
    wrong(
        'one is silent',
        'One of these nodes does not publish at this rate: /left_ear, /right_ear.',
        (SAYS, f"        if self.get_name() == 'left_ear':\n    {SAYS}"),
    ),
    wrong(
        'one is slower',
        'a message every 0.25 s (4 Hz): 1.25 times too slow',
        ('create_timer(0.2', "create_timer(0.2 if self.get_name() == 'left_ear' else 0.25"),
    ),
    wrong('a little too fast', '1.05 times too fast', ('create_timer(0.2', 'create_timer(0.19')),
    wrong(
        'five seconds for five times a second',
        'A rate in Hz and a period in seconds were mixed up',
        ('create_timer(0.2', 'create_timer(5'),
    ),
    wrong('twice each time', 'is publish() called twice', (SAYS, SAYS + SAYS)),
    wrong(
        'one stops after ten',
        'One of these nodes does not publish at this rate: /left_ear, /right_ear.',
        ('        self.timer', '        self.calls = 0\n        self.timer'),
        (
            SAYS,
            '        self.calls += 1\n'
            f"        if self.calls <= 10 or self.get_name() == 'left_ear':\n    {SAYS}",
        ),
    ),
    wrong(
        'nothing in the message',
        'its field data is an empty text at first',
        ("String(data=f'{self.get_name()}: a dog')", 'String()'),
    ),
    wrong(
        'only spaces', 'A text of spaces says nothing.', ("f'{self.get_name()}: a dog'", "'  '")
    ),
    wrong('another topic', 'names must be equal to the last letter', ("'sound'", "'sounds'")),
    wrong(
        'wrong type',
        'A topic carries one type of message.',
        ('import String', 'import Int16'),
        ('(String, ', '(Int16, '),
        ("String(data=f'{self.get_name()}: a dog')", 'Int16(data=7)'),
    ),
    wrong(
        'a third ear',
        '/third_ear publishes there, too',
        (RIGHT, f'{RIGHT}{RUN}third_ear > third_ear.log 2>&1 &\n'),
    ),
    right('functions'),
    right('a loop that sleeps'),
    right(
        'in the folder',
        (LEFT, f'cd nodes\n{LEFT.replace("nodes/", "")}'),
        (RIGHT, RIGHT.replace('nodes/', '')),
    ),
    right(
        'the name as an argument',
        ('import rclpy\n', 'import sys\n\nimport rclpy\n'),
        ("__init__('ear')", '__init__(sys.argv[1])'),
        (LEFT, LEFT.replace('--ros-args -r __node:=', '')),
        (RIGHT, RIGHT.replace('--ros-args -r __node:=', '')),
    ),
    right(
        'a fast timer, each fourth call',
        ('        self.timer', '        self.calls = 0\n        self.timer'),
        ('create_timer(0.2', 'create_timer(0.05'),
        (SAYS, f'        self.calls += 1\n        if self.calls % 4 == 0:\n    {SAYS}'),
    ),
]
