"""Answers to `mend`, and what the check says to each."""

from __future__ import annotations

from cases import right, wrong

__all__ = ['ANSWERS']

SEND = '                self.broadcaster.sendTransform(wanted)\n'

ANSWERS = [
    wrong(
        'moving',
        'On /tf go frames that move.',
        ('Buffer, StaticTransformBroadcaster, T', 'Buffer, TransformBroadcaster, T'),
        ('= StaticTransformBroadcaster', '= TransformBroadcaster'),
    ),
    wrong(
        'the yaw in degrees',
        'one frame',
        ('math.sin(math.radians(yaw) / 2)', 'math.sin(yaw / 2)'),
        ('math.cos(math.radians(yaw) / 2)', 'math.cos(yaw / 2)'),
    ),
    wrong(
        'centimetres',
        'one frame',
        (
            'shift.x, shift.y, shift.z = x, y, z',
            'shift.x, shift.y, shift.z = 100 * x, 100 * y, 100 * z',
        ),
    ),
    wrong(
        'right at first, and wrong later',
        'These are not the numbers of the data sheet',
        (
            SEND,
            f'{SEND}                wanted.transform.translation.x += 0.5\n{SEND}',
        ),
    ),
    right(
        'stays silent about it',
        ("                self.get_logger().info(f'{frame} is wrong')\n", ''),
    ),
    right(
        'sends it three times',
        (SEND, f'                for _ in range(3):\n    {SEND}'),
    ),
    right(
        'a stamp of now',
        (SEND, '                wanted.header.stamp = self.get_clock().now().to_msg()\n' + SEND),
    ),
    right(
        'looks ten times a second',
        ('create_timer(0.2,', 'create_timer(0.1,'),
    ),
]
