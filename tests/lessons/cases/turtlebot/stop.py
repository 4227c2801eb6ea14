"""Answers to `stop`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

RUN = 'env --default-signal=INT python3 nodes/cruiser.py > cruiser.log 2>&1 &\n'
LAST = '        node.publisher.publish(Twist())\n'
WAIT = '        node.publisher.wait_for_all_acked()\n'

ANSWERS = [
    wrong('in the notebook', 'A node of a notebook ends with the notebook.'),
    wrong('not started', 'No program of that name runs on this machine', (RUN, '')),
    wrong(
        'without the line with export',
        'it has none: domain 0',
        (RUN, RUN.replace('env ', 'env -u ROS_DOMAIN_ID ')),
    ),
    wrong(
        'changed while it runs',
        'A program keeps the code with which it was started.',
        (RUN, f'{RUN}touch -d "5 seconds" nodes/cruiser.py\n'),
    ),
    wrong(
        'does not spin',
        'If it ends at once, read there why.',
        ('        rclpy.spin(node)\n', '        pass\n'),
    ),
    wrong(
        'a fault at the start',
        'If it ends at once, read there why.',
        ('from rclpy.node import Node\n', ''),
    ),
    wrong('another file', 'the file nodes/cruise.py', ('> nodes/cruiser.py', '> nodes/cruise.py')),
    wrong(
        'another name',
        'The name of the node is what super().__init__() gets.',
        ("__init__('cruiser')", "__init__('Cruiser')"),
    ),
    wrong(
        'eight commands a second',
        '1.25 times too slow',
        ('create_timer(0.1,', 'create_timer(0.125,'),
    ),
    wrong(
        'the last lines of lesson 02',
        'With Ctrl-C this handler shuts ROS down',
        ('signal_handler_options=SignalHandlerOptions.NO', ''),
        ('    finally:\n', ''),
        (LAST, ''),
        (WAIT, ''),
        ('except KeyboardInterrupt', 'except (KeyboardInterrupt, ExternalShutdownException)'),
        (
            'import rclpy\n',
            'import rclpy\nfrom rclpy.executors import ExternalShutdownException\n',
        ),
    ),
    wrong(
        'publishes before the robot listens',
        'publish() was called too early',
        (
            '        self.timer = self.create_timer(0.1, self.on_timer)\n',
            '        self.on_timer()\n',
        ),
    ),
    wrong(
        'the speed ramps up each time',
        'each command says',
        ('        self.publisher =', '        self.speed = 0.0\n        self.publisher ='),
        (
            '        msg.linear.x = 0.1\n',
            '        self.speed = (self.speed + 0.02) % 0.12\n        msg.linear.x = self.speed\n',
        ),
    ),
    wrong(
        'best effort',
        '/cruiser offers best effort',
        ('import Node\n', 'import Node\nfrom rclpy.qos import qos_profile_sensor_data\n'),
        ("'cmd_vel', 10", "'cmd_vel', qos_profile_sensor_data"),
    ),
    wrong(
        'another topic',
        'names must be equal to the last letter',
        ("'cmd_vel'", "'cmd_velo'"),
    ),
    wrong(
        'a second one drives on',
        'The robot does what the newest command says',
        (RUN, f'{RUN}{RUN.replace("cruiser.py", "cruiser.py --ros-args -r __node:=helper")}'),
    ),
    wrong(
        'Ctrl-C does not end it',
        'a thread or a loop that does not end with it',
        ('        pass\n', '        rclpy.spin(node)\n'),
    ),
    wrong(
        'stops first, and drives once more',
        'The program ends without a word.',
        (LAST, f'{LAST}        node.on_timer()\n'),
    ),
    right(
        'in destroy_node',
        (
            '\n\ndef main',
            '\n    def destroy_node(self):\n        self.publisher.publish(Twist())\n'
            '        self.publisher.wait_for_all_acked()\n        super().destroy_node()\n'
            '\n\ndef main',
        ),
        (LAST, '        node.destroy_node()\n'),
        (WAIT, ''),
    ),
    right('says stop twice', (LAST, f'{LAST}{LAST}')),
    right(
        'each fifth call of a fast timer',
        ('create_timer(0.1,', 'create_timer(0.02,'),
        ('        self.publisher =', '        self.calls = 0\n        self.publisher ='),
        (
            '    def on_timer(self):\n',
            '    def on_timer(self):\n        self.calls += 1\n'
            '        if self.calls % 5:\n            return\n',
        ),
    ),
    right(
        'a loop',
        ('        rclpy.spin(node)\n', '        while True:\n            rclpy.spin_once(node)\n'),
    ),
    right('functions'),
    right('in the folder', (RUN, f'cd nodes\n{RUN.replace("nodes/", "")}')),
]
