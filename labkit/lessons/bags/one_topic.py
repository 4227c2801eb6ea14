"""Exercise: record one topic of several, in the other storage."""

from __future__ import annotations

from itertools import pairwise

from labkit.exercises import Exercise, Fail, Outcome, Probe, Solution, Style, Wrong, changed
from labkit.lessons.bags.content import Found, Is, IsThere, OnlyTopic, judge_bag

__all__ = ['one_topic']

PATH, TOPIC = 'bags/temperature', '/temperature'
FLOAT64 = 'std_msgs/msg/Float64'
LEAST = 20
# How much the temperature of the lesson's weather station rises from one message to the next.
STEP = 0.5

_RECORD = """
recording = lab.record('bags/temperature', '/temperature', storage='sqlite3', overwrite=True)
recording.wait_for(20)
recording.stop()
"""
_CALL = "recording = lab.record('bags/temperature', '/temperature', "


def _enough(found: Found) -> None:
    count = len(found.messages)
    if count < LEAST:
        raise Fail(
            f'at least {LEAST} messages of {TOPIC}',
            f'{count}',
            why='The recording was ended too early.',
            todo=f'Wait before you end it: recording.wait_for({LEAST})',
        )
    values = [each.message.data for each in found.messages]
    for before, after in pairwise(values):
        if abs(after - before - STEP) > 1e-9:
            raise Fail(
                f'temperatures of which each is {STEP} more than the one before',
                f'{before} and then {after}',
                why='Messages are missing in between, or others publish on that topic, too.',
                todo='Record the topic in one go, as the node weather publishes it.',
            )


def _storage(found: Found) -> None:
    if found.bag.storage != 'sqlite3':
        raise Fail(
            'a bag that is stored as sqlite3',
            f'a bag that is stored as {found.bag.storage}',
            why='MCAP is what is taken where nothing else is asked for.',
            todo="Say which storage you want: storage='sqlite3'",
        )


CLAUSES = [
    IsThere(PATH),
    OnlyTopic(TOPIC, FLOAT64),
    Is(f'it has at least {LEAST} messages, with none left out in between', _enough),
    Is('it is stored as sqlite3', _storage),
]


def _judge(probe: Probe) -> str:
    return judge_bag(probe, CLAUSES)


one_topic = Exercise(
    name='one_topic',
    task='Record the topic /temperature, and nothing else.',
    clauses=CLAUSES,
    judge=_judge,
    given={'/weather': 'weather'},
    hints=[
        'lab.record takes the folder of the bag, then the topics.',
        "storage='sqlite3' chooses the other kind of file, and overwrite=True lets you try again.",
        'Wait for a count with recording.wait_for(20), then end it: recording.stop()',
    ],
    answer=Solution(
        _RECORD,
        'The topics are named, and the recording is ended when enough messages have come.',
    ),
    styles=[
        Style(
            'with block',
            """
with lab.record(
    'bags/temperature', '/temperature', storage='sqlite3', overwrite=True
) as recording:
    recording.wait_for(25)
""",
        ),
        Style(
            'count',
            """
recording = lab.record(
    'bags/temperature', ['temperature'], storage='sqlite3', overwrite=True, count=30
)
lab.wait_until(lambda: recording.done)
""",
        ),
        Style(
            'regular expression',
            changed(_RECORD, ("'/temperature', ", "regex='^/temp', ")),
        ),
        Style(
            'all but the others',
            changed(
                _RECORD,
                # Other notebooks of this domain may have topics, too.
                ("'/temperature', storage", "exclude=['^/(?!temp)'], storage"),
                ('recording = lab.record(', 'recording = lab.record(\n    '),
                ('overwrite=True)', 'overwrite=True\n)'),
            ),
        ),
        Style(
            'command line',
            """
import shutil

shutil.rmtree('bags/temperature', ignore_errors=True)
%ros2 bag record -s sqlite3 -o bags/temperature --topics /temperature --count 20
""",
        ),
    ],
    wrong=[
        Wrong(
            'all topics',
            changed(_RECORD, ("'/temperature', ", '')),
            'every node publishes on some topics besides its own',
        ),
        Wrong(
            'MCAP',
            changed(_RECORD, ("storage='sqlite3', ", '')),
            'Say which storage you want',
        ),
        Wrong(
            'not ended',
            changed(_RECORD, ('recording.stop()\n', '')),
            'A recording goes on until it is ended',
        ),
        Wrong(
            'ended too early',
            changed(_RECORD, ('wait_for(20)', 'wait_for(2)')),
            'The recording was ended too early.',
        ),
        Wrong(
            'another topic',
            changed(_RECORD, ("'/temperature', ", "'/wind', ")),
            'What was recorded is another topic.',
        ),
        Wrong(
            'two topics',
            changed(
                _RECORD,
                (_CALL, "NAMES = ['/temperature', '/wind']\n" + _CALL),
                ("'/temperature', storage", 'NAMES, storage'),
                ('recording =', '\nrecording ='),
            ),
            'More was chosen than the one topic.',
        ),
        Wrong(
            'misspelled, and not waited for',
            changed(
                _RECORD, ("'/temperature', ", "'/temprature', "), ('recording.wait_for(20)\n', '')
            ),
            'What nobody publishes while it is recorded is not in a bag.',
        ),
        Wrong(
            'misspelled',
            changed(
                _RECORD,
                ("'/temperature', ", "'/temprature', "),
                ('wait_for(20)', 'wait_for(20, timeout_sec=0.5)'),
            ),
            "None of 20 messages came to 'bags/temperature'",
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'beside the folder',
            changed(_RECORD, ("'bags/temperature'", "'temperature'")),
            'from the folder of this notebook on',
        ),
        Wrong(
            'another name',
            changed(_RECORD, ("'bags/temperature'", "'bags/temperatures'")),
            "Write 'bags/temperature', letter by letter.",
        ),
        Wrong(
            'a part of the name',
            changed(_RECORD, ("'/temperature', ", "regex='t', ")),
            'every node publishes on some topics besides its own',
        ),
        Wrong(
            'the folder is there already',
            "\nlab.record('bags/temperature', '/temperature').stop()"
            f'{changed(_RECORD, (", overwrite=True", ""))}',
            'overwrite=True',
            outcome=Outcome.ERROR,
        ),
    ],
)
