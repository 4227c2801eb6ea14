"""Answers to `wheels`, and what the check says to each."""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

SEND = '        self.broadcaster.sendTransform(transform)\n'
AHEAD = '(self.heading + turn / 2)'

ANSWERS = [
    wrong(
        'the robot tells itself',
        'This robot computes its odometry itself',
        (
            '        self.last = None\n',
            '        self.last = None\n'
            "        self.second = robot.create_publisher(Odometry, 'odom', 10)\n\n"
            '    def destroy_node(self):\n'
            '        robot.destroy_publisher(self.second)\n'
            '        super().destroy_node()\n',
        ),
        refused='The name is not defined.',
    ),
    wrong(
        'the transform leads back',
        'It leads the other way round',
        (
            SEND,
            '        c, s = math.cos(self.heading), math.sin(self.heading)\n'
            '        transform.transform.translation.x = -c * self.at_x - s * self.at_y\n'
            '        transform.transform.translation.y = s * self.at_x - c * self.at_y\n'
            '        transform.transform.rotation.z = -math.sin(self.heading / 2)\n' + SEND,
        ),
        (
            'transform.rotation = odom.pose.pose.orientation',
            'transform.rotation.w = odom.pose.pose.orientation.w',
        ),
    ),
    wrong(
        'transforms sent now and then',
        'tf2 hears /tf only',
        (SEND, '        if stamp.nanosec % 2:\n    ' + SEND),
    ),
    wrong(
        'the frames of the transform swapped',
        'The transform is between other frames, or they are swapped.',
        (
            SEND,
            "        transform.header.frame_id = 'base_footprint'\n"
            "        transform.child_frame_id = 'odom'\n" + SEND,
        ),
        ('TransformStamped(header=odom.header)', 'TransformStamped(header=copy(odom.header))'),
        ('import math\n', 'import math\nfrom copy import copy\n'),
    ),
    wrong(
        'the robot never turns',
        'The way was added to x alone.',
        ('        self.heading += turn\n', ''),
        (
            'way, turn = (left + right) / 2, (right - left) / SEPARATION',
            'way = (left + right) / 2',
        ),
        ('RADIUS, SEPARATION = 0.033, 0.160', 'RADIUS = 0.033'),
        (AHEAD, '(self.heading)'),
    ),
    wrong(
        'right at first, and wrong later',
        'This step is another one',
        (
            '        self.heading += turn\n',
            '        self.heading += turn\n'
            "        self.count = getattr(self, 'count', 0) + 1\n"
            '        self.at_x += 0.01 * (self.count > 20)\n',
        ),
    ),
    wrong(
        'a separation that is nearly right',
        'This step is another one',
        ('0.160', '0.161'),
    ),
    # The wheels of the notebook's robot stand at 0 while the check is awaited, however long.
    wrong(
        'stops after ten',
        'Each message of the wheels is a step.',
        (
            '        self.publisher.publish(odom)\n',
            "        self.count = getattr(self, 'count', 0) + any(self.last)\n"
            '        if self.count > 10:\n            return\n'
            '        self.publisher.publish(odom)\n',
        ),
    ),
    wrong(
        'an int in a float field',
        'takes values of type float',
        ('= self.at_x\n', '= int(self.at_x)\n'),
        outcome=ERROR,
    ),
    wrong('publishes twice', 'leads to one on /odom'),
    # The angle need not be that of the middle of the step: the tolerance is that of the sum.
    right('the heading before the step', (AHEAD, '(self.heading)')),
    right('the heading behind the step', (AHEAD, '(self.heading + turn)')),
    right(
        'on an arc',
        (
            '        self.at_x += way * math.cos(self.heading + turn / 2)\n'
            '        self.at_y += way * math.sin(self.heading + turn / 2)\n',
            '        chord = way * math.sin(turn / 2) / (turn / 2) if turn else way\n'
            '        self.at_x += chord * math.cos(self.heading + turn / 2)\n'
            '        self.at_y += chord * math.sin(self.heading + turn / 2)\n',
        ),
    ),
    right(
        'from the speeds of the wheels',
        ('zip(msg.name, msg.position, strict=True)', 'zip(msg.name, msg.velocity, strict=True)'),
        (
            '        if self.last is not None:\n'
            '            self.roll(RADIUS * (left - self.last[0]), '
            'RADIUS * (right - self.last[1]))\n'
            '        self.last = left, right\n',
            '        now = msg.header.stamp.sec + 1e-9 * msg.header.stamp.nanosec\n'
            '        if self.last is not None:\n'
            '            passed = RADIUS * (now - self.last)\n'
            '            self.roll(left * passed, right * passed)\n'
            '        self.last = now\n',
        ),
    ),
    right(
        'silent until it knows a step',
        (
            '        self.last = left, right\n        self.tell(msg.header.stamp)\n',
            '            self.tell(msg.header.stamp)\n        self.last = left, right\n',
        ),
    ),
    right(
        'the transform first',
        ('        self.publisher.publish(odom)\n', ''),
        (SEND, SEND + '        self.publisher.publish(odom)\n'),
    ),
    right(
        'from anywhere',
        (
            'self.at_x = self.at_y = self.heading = 0.0',
            'self.at_x = self.at_y = self.heading = 2.5',
        ),
    ),
]
