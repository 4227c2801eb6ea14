"""Exercise: find what does not match, and mend the one end that is yours."""

from __future__ import annotations

from labkit.exercises import Exercise, Solution
from labkit.exercises.clauses import Matches, Publishes, Says
from labkit.lessons.quality_of_service.lock import NODE, TOPIC, is_untouched

__all__ = ['exercise']

INT16 = 'std_msgs/msg/Int16'


exercise = Exercise(
    name='door',
    task='Publish 1 on /door, five times a second, so that /lock hears it.',
    clauses=(
        Publishes(TOPIC, 5.0, INT16),
        Says(TOPIC, 1, words='the number is always {}'),
        Matches(
            TOPIC,
            NODE,
            '`/lock` receives what the node publishes, and stays as it is',
            start='Run the cell with start_lock().',
            subscribes=True,
            is_as_given=is_untouched,
        ),
    ),
    hints=[
        'Start the door, and look: lab.doctor() says what the two ends disagree on.',
        'The lock asks for three policies: reliability, durability and deadline. '
        '%ros2 topic info --verbose /door shows what.',
        'QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, '
        'deadline=Duration(seconds=0.5)), from rclpy.qos and rclpy.duration.',
    ],
    answer=Solution(
        __file__,
        'door.py',
        'The door offers all that the lock asks for: reliable, which is the default, transient '
        'local, and a deadline of at most 1 s, which it keeps with a period of 0.2 s.',
    ),
)
