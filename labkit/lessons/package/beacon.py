"""Exercise: a package with a quality of service that serves late listeners, and with a test."""

from __future__ import annotations

from labkit.exercises import Exercise, Fail, Mistake, Solution
from labkit.exercises.clauses import Asked
from labkit.lessons.package.content import TESTED, Built, InAWorkspace, Work
from labkit.lessons.package.running import Running

__all__ = ['exercise']

PACKAGE, TOPIC, BOOL = 'beacon_lab', '/lit', 'std_msgs/msg/Bool'

VOLATILE = Mistake(
    'beacon/a-depth-alone',
    'What is published before somebody subscribes is gone, unless the publisher keeps it.',
    'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)',
    change=[
        ('QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)', '10'),
        ('from rclpy.qos import DurabilityPolicy, QoSProfile\n', ''),
    ],
)
NOTHING = Mistake(
    'beacon/publishes-nothing',
    'The publisher keeps what it has published, and it has published nothing.',
    'self.publisher.publish(Bool(data=True)) in __init__',
    change=[('        self.publisher.publish(Bool(data=True))\n', '')],
)
FALSE = Mistake(
    'beacon/false',
    'A new message begins with False.',
    'Bool(data=True)',
    change=[('Bool(data=True)', 'Bool()')],
)


def _is_heard_late(work: Work) -> None:
    durability = work.end('/beacon', TOPIC, BOOL).qos.durability.name
    if durability != 'TRANSIENT_LOCAL':
        raise Fail('durability TRANSIENT_LOCAL', f'durability {durability}', VOLATILE)
    watch = work.probe.watch(TOPIC, BOOL, latched=True)
    if not work.wait(lambda: len(watch) > 0):
        raise Fail(f'True on {TOPIC}, for a subscriber that comes late', 'nothing', NOTHING)
    if watch[-1].data is not True:
        raise Fail('True', repr(watch[-1].data), FALSE)


exercise = Exercise(
    name='beacon',
    task='Make the package beacon_lab, whose node says once that it is lit, and test it.',
    clauses=(
        Built(PACKAGE),
        Running('beacon', 'beacon', PACKAGE),
        Asked(
            'a subscriber that comes late to `/lit` (`std_msgs/msg/Bool`), with durability '
            'transient local, gets `True`',
            _is_heard_late,
        ),
        TESTED,
    ),
    stage=InAWorkspace(PACKAGE),
    hints=[
        'Lesson 08 has the profile: QoSProfile with a depth and a durability.',
        'The node publishes once, in its __init__. A publisher that is TRANSIENT_LOCAL keeps it.',
        'Take the three tests away that ros2 pkg create has made, and write test/test_beacon.py, '
        'as in this lesson. Build first, then colcon test --packages-select beacon_lab',
    ],
    answer=Solution(
        __file__,
        'beacon.sh',
        'The publisher keeps its one message for those who come late. The test makes the node, '
        'and looks at its name. This cell does it all at once: cat writes a file, and & stands '
        'for a second terminal.',
    ),
)
