"""Exercise: the number 1, without end."""

from __future__ import annotations

from labkit.exercises import Exercise, Mistake, Solution, anything
from labkit.exercises.clauses import Publishes, Says

__all__ = ['exercise']

INT16 = 'std_msgs/msg/Int16'


MISTAKES = (
    Mistake(
        'ones/never-set',
        'The message was published as it was made: its field data is 0 at first.',
        'Set the field before you publish: msg.data = 1',
        model=lambda: 0,
        change=[('        msg.data = 1\n', '')],
    ),
    Mistake(
        'ones/another-number',
        'Another number is put into the message.',
        'The field data is to be 1, in each message.',
        model=anything,
        change=[('msg.data = 1', 'msg.data = 10')],
    ),
)

exercise = Exercise(
    name='ones',
    task='Publish the `Int16` 1 on /ones ten times a second, without end.',
    clauses=(
        Publishes('/ones', 10.0, INT16),
        Says('/ones', 1, words='the number is always {}', mistakes=MISTAKES),
    ),
    hints=[
        'The talker of the lesson "Talker and listener" does nearly the same. Its type is String, '
        'and its text changes.',
        'Four things are needed: a name for the node, create_publisher(Int16, ...), a timer with '
        'a period of 0.1 s, and a callback that publishes.',
        'In the callback: msg = Int16(), then msg.data = 1, then self.publisher.publish(msg).',
    ],
    answer=Solution(
        __file__,
        'ones.py',
        'A rate of 10 Hz is a period of 0.1 s. The number goes into the field data: publish() '
        'takes a message, never a bare number.',
    ),
)
