"""Answers to `mount`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

SEND = '        self.broadcaster.sendTransform(mount)\n'
IMPORT = 'from tf2_ros import StaticTransformBroadcaster\n'
BROADCASTER = '        self.broadcaster = StaticTransformBroadcaster(self)\n'
OWN = (
    "        self.publisher = self.create_publisher(TFMessage, '/tf_static', {})\n",
    '        self.publisher.publish(TFMessage(transforms=[mount]))\n',
)

ANSWERS = [
    wrong(
        'a publisher that keeps nothing',
        'uses durability volatile',
        (IMPORT, 'from tf2_msgs.msg import TFMessage\n'),
        (BROADCASTER, OWN[0].format('10')),
        (SEND, OWN[1]),
    ),
    wrong(
        'an int in a float field',
        'takes values of type float',
        ('= 0.12', '= 12'),
        outcome=ERROR,
    ),
    wrong(
        'first rightly, later wrongly',
        'It is mounted somewhere else',
        (SEND, f'{SEND}        mount.transform.translation.x = 0.07\n{SEND}'),
    ),
    wrong(
        'a place that is nearly right',
        'It is mounted somewhere else',
        ('= 0.06', '= 0.0605'),
    ),
    # Nothing has to be called for what is sent once.
    right('not spun'),
    right(
        'sends it again and again',
        (
            f'{SEND}\n\n',
            '        self.mount = mount\n        self.create_timer(0.5, self.on_timer)\n\n'
            '    def on_timer(self):\n        self.broadcaster.sendTransform(self.mount)\n\n\n',
        ),
    ),
    right(
        'the other quaternion of the same turn',
        ('= math.sin', '= -math.sin'),
        ('= math.cos', '= -math.cos'),
    ),
    right('a list of one', ('sendTransform(mount)', 'sendTransform([mount])')),
    right(
        'a publisher of its own',
        (
            IMPORT,
            'from rclpy.qos import DurabilityPolicy, QoSProfile\n'
            'from tf2_msgs.msg import TFMessage\n',
        ),
        (
            BROADCASTER,
            '        profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)\n'
            f'{OWN[0].format("profile")}',
        ),
        (SEND, OWN[1]),
    ),
]
