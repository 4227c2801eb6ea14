"""Exercise: hear the odd numbers, and publish even ones."""

from __future__ import annotations

from labkit.exercises import Exercise, Mistake, Solution, anything
from labkit.exercises.clauses import WITHIN, Answers
from labkit.exercises.draws import draw_int16s

__all__ = ['exercise']

INT16 = 'std_msgs/msg/Int16'
MORE = 1


_ADD = 'The value to publish is msg.data, plus 1.'
MISTAKES = (
    Mistake(
        'evens/passed-on',
        'The number is passed on as it came.',
        _ADD,
        model=lambda n: n,
        change=[('msg.data + 1', 'msg.data')],
    ),
    Mistake(
        'evens/subtracted',
        '1 is subtracted, and not added.',
        _ADD,
        model=lambda n: n - 1,
        change=[('msg.data + 1', 'msg.data - 1')],
    ),
    Mistake(
        'evens/no-sign',
        'The sign of the number is lost.',
        _ADD,
        model=lambda n: abs(n) + 1,
        change=[('msg.data + 1', 'abs(msg.data) + 1')],
    ),
    Mistake(
        'evens/doubled',
        'The number is doubled. 1 becomes 2, but 3 becomes 6.',
        _ADD,
        model=lambda n: 2 * n,
        change=[('msg.data + 1', '2 * msg.data')],
    ),
    Mistake(
        'evens/of-its-own',
        'What is published does not depend on the number that came. Does the node count by '
        'itself?',
        'Use the number in the message.',
        model=anything,
    ),
)

exercise = Exercise(
    name='evens',
    task='Subscribe to /odds, add 1 to each number and publish the result on /evens (`Int16`).',
    clauses=(
        Answers(
            '/odds',
            '/evens',
            INT16,
            f'for each number on `/odds`, publish that number plus {MORE} on `/evens` '
            f'(both `{INT16}`), once, {WITHIN}',
            answer=lambda number: number + MORE,
            draw=lambda: draw_int16s(-32767, 32765, 2),
            mistakes=MISTAKES,
        ),
    ),
    hints=[
        'One node may have a publisher and a subscription. Make both in __init__.',
        'The callback of the subscription gets the odd number, in msg.data. There the even one is '
        'made and published.',
        'even = Int16(), then even.data = msg.data + 1, then self.publisher.publish(even). No '
        'timer is needed.',
    ],
    answer=Solution(
        __file__,
        'evens.py',
        'The subscription gives the beat: for each message that comes, one goes out. The node '
        'does not know who publishes on /odds, nor who listens to /evens.',
    ),
)
