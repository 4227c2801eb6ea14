"""Exercise: record one topic of several, in the other storage."""

from __future__ import annotations

from itertools import pairwise

from labkit.exercises import Exercise, Fail, Mistake, Solution
from labkit.exercises.clauses import Asked
from labkit.lessons.bags.content import Found, InABag, IsThere, OnlyTopic

__all__ = ['exercise']

PATH, TOPIC, FLOAT64 = 'bags/temperature', '/temperature', 'std_msgs/msg/Float64'
LEAST = 20
# How much the temperature of the lesson's weather station rises from one message to the next.
STEP = 0.5

TOO_FEW = Mistake(
    'one_topic/ended-too-early',
    'The recording was ended too early.',
    'Wait before you end it: recording.wait_for(20)',
    change=[('wait_for(20)', 'wait_for(2)')],
)
LEFT_OUT = Mistake(
    'one_topic/left-out',
    'Messages are missing in between.',
    'Record the topic in one go, as the node weather publishes it.',
)
TWICE = Mistake(
    'one_topic/twice',
    'The same temperature was recorded twice: two recordings write, or two nodes publish.',
    'Let one recording run, while the node weather alone publishes.',
)
STEPS_BACK = Mistake(
    'one_topic/steps-back',
    'The temperature falls: a second node publishes there, too, or the weather began anew.',
    'Let the node weather alone publish, and record once more.',
)
MCAP = Mistake(
    'one_topic/mcap',
    'MCAP is the default storage.',
    "Say which storage you want: storage='sqlite3'",
    change=[("storage='sqlite3', ", '')],
)


def _enough(found: Found) -> None:
    if len(found.messages) < LEAST:
        raise Fail(f'at least {LEAST} messages of {TOPIC}', f'{len(found.messages)}', TOO_FEW)
    for before, after in pairwise(each.message.data for each in found.messages):
        if abs(after - before - STEP) > 1e-9:
            raise Fail(
                f'temperatures of which each is {STEP} more than the one before',
                f'{before} and then {after}',
                LEFT_OUT if after > before else TWICE if after == before else STEPS_BACK,
            )


def _storage(found: Found) -> None:
    storage = found.bag.storage
    if storage != 'sqlite3':
        raise Fail('a bag that is stored as sqlite3', f'a bag that is stored as {storage}', MCAP)


exercise = Exercise(
    name='one_topic',
    task='Record the topic /temperature, and nothing else.',
    clauses=(
        IsThere(PATH),
        OnlyTopic(TOPIC, FLOAT64),
        Asked(f'it has at least {LEAST} messages, with none left out in between', _enough),
        Asked('it is stored as sqlite3', _storage),
    ),
    stage=InABag(PATH, TOPIC),
    given={'/weather': 'weather'},
    hints=[
        'lab.record takes the folder of the bag, then the topics.',
        "storage='sqlite3' chooses the other kind of file, and overwrite=True lets you try again.",
        'Wait for a count with recording.wait_for(20), then end it: recording.stop()',
    ],
    answer=Solution(
        __file__,
        'one_topic.py',
        'The topics are named, and the recording is ended when enough messages have come.',
    ),
)
