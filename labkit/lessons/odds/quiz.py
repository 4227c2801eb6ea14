"""The quiz on types, limits and queues."""

from __future__ import annotations

from labkit.exercises import Choice, Number, Quiz, Several, right, wrong
from labkit.lessons.odds.stadium import VISITORS

__all__ = ['QUIZ', 'WARM_UP']


def _publishers_of_visitors() -> int:
    """Count the publishers of the stadium's topic at this moment."""
    from labkit.asking.discovery import asking_node

    return asking_node().count_publishers(VISITORS)


def _stadium_is_closed(number: float) -> str:
    """Say which cell opens the stadium, if nobody publishes there."""
    if _publishers_of_visitors():
        return ''
    return 'At this moment there is none. Run the cell with open_stadium(), and count again.'


WARM_UP = Quiz(
    'warm_up',
    Choice(
        'Which command shows how many messages come in a second?',
        right('ros2 topic hz', 'It subscribes, and measures the rate.'),
        wrong('ros2 topic info', 'It counts publishers and subscriptions, not messages.'),
        wrong('ros2 topic echo', 'It shows each message, and measures nothing.'),
    ),
    Choice(
        'You publish a Twist from the command line, and name only `linear.x`. What is in its '
        'other fields?',
        right('0', 'Fields that are not named keep their defaults.'),
        wrong('what was there before', 'Each message is a new one, without a memory.'),
        wrong('nothing: it is refused', 'A message always has all of its fields.'),
    ),
    Choice(
        'A node is not spun. Five letters come to its subscriber, whose depth is 3. Then the node '
        'is spun. Which one does it hear first?',
        right('the third', 'The newest three have waited. The two oldest fell out.'),
        wrong('the first', 'It fell out when the fourth one came.'),
        wrong('the fifth', 'That is the newest. What waited longest is heard first.'),
    ),
    cell_id='warm-up',
)

QUIZ = Quiz(
    'odds',
    Choice(
        'msg = Int16(data=7). What does msg + 1 give?',
        right(
            'An error: a message is not a number.',
            'The number is an attribute of the message: msg.data + 1 gives 8.',
        ),
        wrong('8', 'msg.data + 1 gives 8. The message itself is an object with fields.'),
        wrong(
            'A message whose field data is 8.',
            'Messages do not calculate. Make a new one: Int16(data=msg.data + 1)',
        ),
    ),
    Several(
        'Which values can the field data of an Int16 hold?',
        right('-32768', 'It is the smallest one: half of the 65536 values are below zero.'),
        right('0', 'It is what a new message holds.'),
        wrong('32768', 'The largest one is 32767. Zero takes the place of one of the others.'),
        wrong('7.0', 'That is a float. A message does not convert it to an int.'),
        wrong("'7'", 'That is a text. A message does not convert it: write int(...) around it.'),
    ),
    Number(
        'A program that does not check fields sends 32769 as an Int16. Which number arrives?',
        -32767,
        '16 bits start over: 32769 - 65536 = -32767.',
        'The 65536 values lie on a circle. How far beyond 32767 is 32769?',
        wrong={
            32769: 'It does not fit into 16 bits, so it cannot arrive as it is.',
            32767: 'Nothing is cut off at the limit. The values start over from below.',
            1: 'After 32767 comes -32768, the smallest number, and not 0.',
            -32768: 'That is what 32768 becomes. 32769 is one step further.',
        },
    ),
    Number(
        'While a subscriber of depth 5 is busy, 20 messages are published. How many are lost?',
        15,
        'The queue keeps the newest five. 20 - 5 = 15 are lost.',
        'The depth says how many messages may wait. The others fall out.',
        wrong={
            5: 'That is how many are heard.',
            0: 'A queue has an end. What does not fit pushes the oldest out.',
            20: 'The newest five wait in the queue, and are heard.',
        },
    ),
    Choice(
        'In one program a node publishes Int16 on /level, in another one a node subscribes to '
        '/level with String. What happens?',
        right(
            'Nothing. No message arrives, and nobody reports an error.',
            'The two do not match, and to ROS that is no error. The graph shows it.',
        ),
        wrong(
            'The numbers arrive as texts.',
            'Messages are never converted. A subscriber gets messages of its own type only.',
        ),
        wrong(
            'The subscriber raises an error.',
            'Only within one process is a second type refused. Between processes it is silent.',
        ),
    ),
    Number(
        f'How many nodes publish on {VISITORS} at this moment? Ask the graph.',
        _publishers_of_visitors,
        'The graph says so too: each gate has one publisher there.',
        f"Count the entries of get_publishers_info_by_topic('{VISITORS}').",
        explain=_stadium_is_closed,
    ),
)
