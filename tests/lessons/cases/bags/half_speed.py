"""Answers to `half_speed`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong(
        'sideways, too',
        'linear.y = 0.1',
        ('        half.angular.z', '        half.linear.y = 0.1\n        half.angular.z'),
    ),
    wrong(
        'nearly half',
        'half of the command at this place',
        ('msg.linear.x / 2', 'msg.linear.x / 2.0001'),
    ),
    wrong(
        'plays first, then records',
        'The recording had ended before the first message came.',
        (
            '\n'
            "with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as "
            "recording:\n    lab.play('bags/commands', '/cmd_vel', wait=True)\n"
            '    recording.wait_for(30)\n',
            "\nlab.play('bags/commands', '/cmd_vel', rate=10.0, wait=True)\n"
            "with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as "
            'recording:\n    pass\n',
        ),
    ),
    wrong(
        'does not wait',
        'What comes after them is missing.',
        (', wait=True', ''),
        ('wait_for(30)', 'wait_for(3)'),
    ),
    wrong(
        'not backwards',
        'half of the command at this place',
        ('msg.linear.x / 2', 'max(0.0, msg.linear.x / 2)'),
    ),
    wrong(
        'a stop of its own at the end',
        'All commands are there, and 1 more after them',
        (
            '    recording.wait_for(30)\n',
            '    recording.wait_for(30)\n    half_speed.publisher.publish(Twist())\n'
            '    recording.wait_for(31)\n',
        ),
    ),
    wrong(
        'no command twice',
        'has no message, and later ones have.',
        (
            '    def on_command(self, msg):\n',
            '    def on_command(self, msg):\n'
            "        if msg == getattr(self, 'last', None):\n            return\n"
            '        self.last = msg\n',
        ),
        ('wait_for(30)', 'wait_for(29)'),
    ),
    wrong(
        'records all',
        'All that is published was recorded',
        ("'/slow/cmd_vel', overwrite", 'overwrite'),
    ),
    wrong(
        'records both',
        'More than one topic was chosen.',
        ("'/slow/cmd_vel', overwrite", "regex='cmd_vel', overwrite"),
    ),
    wrong('remapped only', 'The commands are in the bag as they were.'),
    wrong(
        'publishes what came, too',
        'Commands came more than once',
        (
            '        self.publisher.publish(half)\n',
            '        self.publisher.publish(msg)\n        self.publisher.publish(half)\n',
        ),
        ('wait_for(30)', 'wait_for(60)'),
    ),
    wrong(
        'another topic',
        'Another topic was recorded.',
        ("Twist, 'slow/cmd_vel'", "Twist, 'cmd_vel/slow'"),
        ("'/slow/cmd_vel', overwrite", "'/cmd_vel/slow', overwrite"),
    ),
    wrong(
        'not ended',
        'A recording goes on until it is ended',
        (
            '\n'
            "with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as "
            "recording:\n    lab.play('bags/commands', '/cmd_vel', wait=True)\n"
            '    recording.wait_for(30)\n',
            "\nlab.record('bags/slow', '/slow/cmd_vel', overwrite=True)\n",
        ),
    ),
    wrong('from the last one to the first', 'half of the command at this place'),
    wrong(
        'at most 0.05',
        'half of the command at this place',
        ('msg.linear.x / 2', 'min(0.05, msg.linear.x / 2)'),
    ),
    right('faster', ("'/cmd_vel', wait=True", 'rate=5.0, wait=True')),
    right(
        'other ends',
        (
            '\n'
            "with lab.record('bags/slow', '/slow/cmd_vel', overwrite=True) as "
            "recording:\n    lab.play('bags/commands', '/cmd_vel', wait=True)\n"
            '    recording.wait_for(30)\n',
            '\n'
            "recording = lab.record('bags/slow', regex='^/slow/', overwrite=True, "
            "storage='sqlite3')\nplaying = lab.play('bags/commands', paused=True)\n"
            "playing.resume()\nplaying.wait()\nrecording.wait_for(30, '/slow/cmd_vel')\n"
            'recording.stop()\n',
        ),
    ),
    right(
        'remapped',
        ("Twist, 'cmd_vel'", "Twist, 'fast'"),
        ("'/cmd_vel', wait=True", "remap={'/cmd_vel': '/fast'}, wait=True"),
    ),
    right(
        'changes the message that came',
        (
            '        half = Twist()\n        half.linear.x = msg.linear.x / 2\n'
            '        half.angular.z = msg.angular.z / 2\n'
            '        self.publisher.publish(half)\n',
            '        msg.linear.x *= 0.5\n        msg.angular.z *= 0.5\n'
            '        self.publisher.publish(msg)\n',
        ),
    ),
    right('reads the bag itself'),
]
