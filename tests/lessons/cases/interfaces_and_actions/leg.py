"""Answers to `leg`, and what the check says to each.

A kernel loads a type once, so all of them load the right one; `test_leg.py` has more others.
"""

from __future__ import annotations

from cases import ERROR, right, wrong

__all__ = ['ANSWERS']

ANSWERS = [
    wrong('not spun', 'lab.spin(node)', ('lab.spin(Walker())', 'walker = Walker()')),
    wrong(
        'another field in the type',
        'Seen: float64 velocity',
        (
            '%ros2 interface show legs_lab/msg/Leg\n',
            # What was built of such a type, without loading it.
            "installed = Path('legs_ws/install/legs_lab/share/legs_lab/msg/Leg.msg')\n"
            "installed.write_text('float64 velocity')\n",
        ),
    ),
    wrong('another topic', "Write the topic as '/leg'", ("'leg', self", "'legs', self")),
    wrong('another node name', 'a node called /walker', ("'walker'", "'walkers'")),
    wrong(
        'once for two',
        'were answered correctly, the others were not.',
        (
            '        command = Twist()\n',
            "        self.count = getattr(self, 'count', 0) + 1\n"
            '        if self.count % 2:\n            return\n        command = Twist()\n',
        ),
    ),
    wrong(
        'twice',
        'more than once',
        (
            '        self.publisher.publish(command)\n',
            '        self.publisher.publish(command)\n        self.publisher.publish(command)\n',
        ),
    ),
    wrong(
        'another field',
        "has no attribute 'velocity'",
        ('msg.speed', 'msg.velocity'),
        outcome=ERROR,
    ),
    right('the whole message at once', ('msg.speed\n', 'float(msg.speed)\n')),
    right(
        'a function',
        (
            '        command = Twist()\n        command.linear.x = msg.speed\n'
            '        command.angular.z = msg.turn\n        self.publisher.publish(command)\n',
            '        self.publisher.publish(command_of(msg))\n\n\n'
            'def command_of(leg):\n    command = Twist()\n    command.linear.x = leg.speed\n'
            '    command.angular.z = leg.turn\n    return command\n',
        ),
    ),
    right(
        'with vectors',
        ('import Twist\n', 'import Twist, Vector3\n'),
        (
            '        command = Twist()\n        command.linear.x = msg.speed\n'
            '        command.angular.z = msg.turn\n',
            '        command = Twist(linear=Vector3(x=msg.speed), angular=Vector3(z=msg.turn))\n',
        ),
    ),
    right(
        'a timer for what has come',
        (
            '    def on_leg(self, msg):\n',
            '        self.legs = []\n        self.create_timer(0.1, self.on_timer)\n\n'
            '    def on_leg(self, msg):\n        self.legs.append(msg)\n\n'
            '    def on_timer(self):\n        while self.legs:\n'
            '            self.drive(self.legs.pop(0))\n\n    def drive(self, msg):\n',
        ),
    ),
]
