"""Exercise: 1, 3 and 5 from the command line, one message each."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from labkit.exercises import (
    Exercise,
    Fail,
    NotAttempted,
    Probe,
    Solution,
    Style,
    Wrong,
    changed,
    expect,
)
from labkit.exercises.watch import Sample
from labkit.lessons.command_line.sent import Asked, OnTopic, Sent, judge_sent

__all__ = ['odds']

INT16 = 'std_msgs/msg/Int16'
TOPIC = '/odds'
WANTED = [1, 3, 5]
EXPECTED = f'the numbers 1, 3 and 5 on {TOPIC}, one message each'

_ONE = '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 1}"\n'
_COMMANDS = ''.join(changed(_ONE, ('1}', f'{number}}}')) for number in WANTED)


def _judge_odds(probe: Probe) -> str:
    judge_sent(
        probe,
        _WHERE,
        _CLAUSES,
        EXPECTED,
        is_whole=_is_whole,
        is_too_much=_is_repeated,
        keep=_right_so_far,
    )
    return 'The numbers 1, 3 and 5 came on /odds, one message each.'


def _values(samples: Sequence[Sample]) -> list[int]:
    return [sample.message.data for sample in samples]


def _is_whole(samples: Sequence[Sample]) -> bool:
    return len(_beginning(samples)) == len(WANTED)


def _beginning(samples: Sequence[Sample]) -> Sequence[Sample]:
    """Return the last messages that are 1, 3 and 5, or 1 and 3, or 1; else nothing."""
    for count in range(len(WANTED), 0, -1):
        before, last = samples[:-count], samples[-count:]
        if _values(last) != WANTED[:count]:
            continue
        # What the same publisher has sent just before belongs to it, unless it was whole, too.
        if (
            not before
            or not _is_next(before[-1], last[0])
            or before[-1].message.data == WANTED[-1]
        ):
            return last
    return ()


def _is_next(earlier: Sample, later: Sample) -> bool:
    """Tell whether two messages are one publisher's, one after the other."""
    return 0 < earlier.number == later.number - 1


def _is_repeated(samples: Sequence[Sample]) -> bool:
    """Tell whether one publisher has sent the same number twice in a row."""
    return any(
        _is_next(earlier, later) and earlier.message.data == later.message.data
        for earlier, later in pairwise(samples)
    )


def _right_so_far(sent: Sent) -> Sequence[Sample]:
    """Return the messages that the next attempt may go on from: a wrong one changes nothing."""
    begun = _beginning(sent.samples)
    return begun if 0 < len(begun) < len(WANTED) else sent.earlier


def _expect_once(sent: Sent) -> None:
    seen = f'data = {expect.show(_values(sent.samples))}'
    why = 'Without --once a command goes on publishing, as a loop without an end does.'
    expect.that(
        not sent.goes_on,
        expected=EXPECTED,
        seen=f'messages that go on coming: {seen}',
        why=why,
        todo='End it, and publish the three numbers once.',
    )
    expect.that(
        _is_whole(sent.samples) or not _is_repeated(sent.samples),
        expected=EXPECTED,
        seen=seen,
        why=f'The same number came more than once. {why}',
        todo=_next_step(sent),
    )


def _expect_numbers(sent: Sent) -> None:
    if _is_whole(sent.samples):
        return
    values = _values(sent.samples)
    if sent.is_running and _beginning(sent.samples):
        raise NotAttempted(
            f'data = {expect.show(values)} so far, and a command still runs. Run this cell again '
            'when it has ended.'
        )
    missing = [number for number in WANTED if number not in values]
    if all(value % 2 == 0 for value in _values(sent.new)):
        why = 'These are even numbers. An odd number leaves 1 when it is divided by 2.'
    elif missing:
        why = f'Still missing: {", ".join(map(str, missing))}.'
    elif sorted(values) == WANTED:
        why = 'All three came, but in another order.'
    else:
        why = 'Other numbers came as well, or a number came twice.'
    raise Fail(EXPECTED, f'data = {expect.show(values)}', why=why, todo=_next_step(sent))


def _next_step(sent: Sent) -> str:
    kept = len(_right_so_far(sent))
    if not kept:
        return 'Publish all three numbers again: 1, then 3, then 5.'
    return f'Go on with {", then ".join(map(str, WANTED[kept:]))}.'


_WHERE = OnTopic(TOPIC, INT16)
_CLAUSES = (
    Asked('one message for each number', _expect_once),
    Asked('1, then 3, then 5, and nothing after them', _expect_numbers),
)

odds = Exercise(
    name='odds',
    task='Publish three odd numbers from the command line.',
    clauses=[_WHERE, *_CLAUSES],
    publishes={TOPIC: INT16},
    shared=[TOPIC],
    judge=_judge_odds,
    hints=[
        'One command publishes one message. Which option makes a command end after it?',
        'The order of the words: ros2 topic pub --once, the topic, the type, and the YAML in '
        'quotation marks.',
        'The first of the three: ' + _ONE.strip(),
    ],
    answer=Solution(
        _COMMANDS,
        '--once waits for a subscriber, publishes one message, and ends. Each number is a message '
        'of its own, so there are three commands.',
    ),
    styles=[
        Style(
            'short names, other quotation marks',
            "%ros2 topic pub -1 odds std_msgs/Int16 '{data: 1}'\n"
            '%ros2 topic pub -t 1 odds std_msgs/msg/Int16 "data: 3"\n'
            '%ros2 topic pub -1 -n me /odds std_msgs/msg/Int16 "data: 5"\n',
        ),
        Style('also with the command of the shell', changed(_COMMANDS, (_ONE, f'!{_ONE[1:]}'))),
        Style('after a wrong one', changed(_ONE, ('1}', '8}')) + _COMMANDS),
        Style('twice', _COMMANDS * 2),
        Style('the first one twice', _ONE + _COMMANDS),
        Style(
            'after another type, which is refused',
            changed(_COMMANDS, ('Int16', 'Int32')) + _COMMANDS,
        ),
        Style(
            'in the background',
            ''.join(f'{line} &\n' for line in _COMMANDS.splitlines()),
        ),
        Style(
            'a node',
            """
import rclpy
from std_msgs.msg import Int16

node = rclpy.create_node('odd_node')
publisher = node.create_publisher(Int16, 'odds', 10)
for number in (1, 3, 5):
    publisher.publish(Int16(data=number))
""",
        ),
    ],
    wrong=[
        Wrong(
            'evens',
            changed(_COMMANDS, ('1}', '2}'), ('3}', '4}'), ('5}', '6}')),
            'These are even numbers.',
        ),
        Wrong('no space', changed(_ONE, (': 1', ':1')), 'a colon is followed by a space'),
        Wrong(
            'no quotation marks',
            changed(_ONE, ('"', '')),
            'Quotation marks around the YAML hold its words together.',
        ),
        Wrong(
            'all in one message',
            changed(_ONE, ('1}', '[1, 3, 5]}')),
            'each number needs a message of its own',
        ),
        Wrong(
            'without --once',
            changed(_ONE, ('--once', '--rate 20 --timeout 0.3')),
            'Without --once a command goes on publishing',
        ),
        Wrong(
            'capital letter',
            changed(_COMMANDS, ('--once /odds', '--once -w 0 /Odds')),
            'Capital and small letters differ in names: /Odds and /odds',
        ),
        Wrong(
            'another name', changed(_ONE, ('--once /odds', '-1 -w 0 /odd')), '/odd is not /odds'
        ),
        Wrong(
            'text for a number',
            changed(_ONE, ('Int16', 'String'), ('1}', "'1'}")),
            'A topic carries one type of message.',
        ),
        Wrong('type cut short', changed(_ONE, ('std_msgs/msg/', '')), 'a type has three parts'),
        Wrong('a word', changed(_ONE, ('1}', 'one}')), 'written in digits'),
        Wrong('two slashes', changed(_ONE, ('/odds', '//odds')), 'One slash at the beginning'),
        Wrong('only two', changed(_COMMANDS, (_ONE, '')), 'Still missing: 1.'),
        Wrong('only the first', _ONE, 'Still missing: 3, 5. Next: Go on with 3, then 5.'),
        Wrong(
            'in another order',
            changed(_COMMANDS, ('1}', '0}'), ('5}', '1}'), ('0}', '5}')),
            'All three came, but in another order.',
        ),
        Wrong('one more', _COMMANDS + changed(_ONE, ('1}', '7}')), 'Other numbers came as well'),
        Wrong(
            'all numbers',
            ''.join(changed(_ONE, ('1}', f'{number}}}')) for number in range(1, 6)),
            'Other numbers came as well',
        ),
        Wrong(
            'twice each',
            changed(_COMMANDS, ('--once', '--times 2 --rate 20')),
            'The same number came more than once',
        ),
        Wrong(
            'another topic, too',
            _COMMANDS + changed(_ONE, ('--once /odds', '--once -w 0 /odd_numbers')),
            'messages on /odd_numbers as well',
        ),
        Wrong(
            'a loop without an end',
            """
import rclpy
from std_msgs.msg import Int16

node = lab.spin(rclpy.create_node('odd_loop'))
publisher = node.create_publisher(Int16, 'odds', 10)
numbers = [1, 3, 5]


def on_timer():
    publisher.publish(Int16(data=numbers[0]))
    numbers.append(numbers.pop(0))


timer = node.create_timer(0.1, on_timer)
""",
            'messages that go on coming',
        ),
    ],
    records=[TOPIC],
)
