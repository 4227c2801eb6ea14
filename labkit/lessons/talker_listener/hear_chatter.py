"""Exercise: a subscriber on /chatter."""

from __future__ import annotations

from labkit.exercises import Exercise, Solution
from labkit.exercises.clauses import WITHIN, Logs, Subscribes

__all__ = ['exercise']

STRING = 'std_msgs/msg/String'


exercise = Exercise(
    name='hear_chatter',
    task='Write a node that subscribes to /chatter and logs the text of each `String`.',
    clauses=(
        Subscribes('/chatter', STRING),
        Logs(
            '/chatter',
            STRING,
            f'for each message, log one line that holds its text, {WITHIN}, and no other line',
        ),
    ),
    hints=[
        'The class Listener is nearly what you need.',
        'create_subscription() takes four things: type, topic, callback, depth. The callback '
        'takes the message.',
        'In the callback: self.get_logger().info(f\'I heard: "{msg.data}"\')',
    ],
    answer=Solution(
        __file__,
        'hear_chatter.py',
        'The callback is passed by its name. ROS calls it for each message, and the text is in '
        'msg.data.',
    ),
)
