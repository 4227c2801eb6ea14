"""Exercise: 1, 3 and 5 from the command line, one message each."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NoReturn

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
from labkit.lessons.command_line.last_command import heard

__all__ = ['odds']

INT16 = 'std_msgs/msg/Int16'
TOPIC = '/odds'
WANTED = [1, 3, 5]
EXPECTED = f'the numbers 1, 3 and 5 on {TOPIC}, one message each'

_ONE = '%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 1}"\n'
_COMMANDS = ''.join(changed(_ONE, ('1}', f'{number}}}')) for number in WANTED)


def _judge_odds(probe: Probe) -> str:
    _refuse_other_types(probe)
    recorded = heard(probe, TOPIC, len(WANTED), EXPECTED)
    if not recorded:
        raise NotAttempted(
            f'Not attempted yet: nothing has come on {TOPIC}. Write your commands in the cell '
            'above, run that cell, then run this one again. If a command says that something '
            'is wrong, nothing was sent.'
        )
    values = recorded.values('data')
    # Who has run the cell twice, or has tried something before, is right in the end.
    if values[-3:] != WANTED or values[-4:-3] == WANTED[:1]:
        _refuse(values)
    return 'The numbers 1, 3 and 5 came on /odds, one message each.'


def _refuse_other_types(probe: Probe) -> None:
    """Raise Fail if a command, of a terminal perhaps, waits with another type."""
    for info in probe.node.get_publishers_info_by_topic(TOPIC):
        expect.that(
            info.topic_type == INT16,
            expected=EXPECTED,
            seen=f'a publisher on {TOPIC} with messages of type {info.topic_type}',
            why='A topic carries one type of message. Nobody hears messages of another type.',
            todo=f'Stop that command with Ctrl-C, and use {INT16}.',
        )


def _refuse(values: Sequence[int]) -> NoReturn:
    missing = [number for number in WANTED if number not in values]
    todo = 'Publish all three numbers again: 1, then 3, then 5.'
    if all(value % 2 == 0 for value in values):
        why = 'These are even numbers. An odd number leaves 1 when it is divided by 2.'
    elif any(earlier == later for earlier, later in pairwise(values)):
        why = 'The same number came more than once: without --once a command goes on publishing.'
        todo = 'Add --once to each command, and publish all three again.'
    elif missing:
        why = f'Still missing: {", ".join(map(str, missing))}.'
    elif sorted(values) == WANTED:
        why = 'All three came, but in another order.'
    else:
        why = 'Other numbers came as well.'
    raise Fail(EXPECTED, f'data = {expect.show(values)}', why=why, todo=todo)


odds = Exercise(
    name='odds',
    task=f'Publish the numbers 1, 3 and 5 on {TOPIC} from the command line, as `{INT16}`, one '
    'message each.',
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
            'without --once a command goes on publishing',
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
    ],
    records=[TOPIC],
)
