"""Exercise: record one topic of several, in the other storage."""

from __future__ import annotations

from itertools import pairwise

from labkit.exercises import Exercise, Fail, words_of
from labkit.exercises.clauses import Asked
from labkit.lessons.bags.content import Found, InABag, IsThere, OnlyTopic

__all__ = ['exercise']

WORDS = words_of(__file__)

PATH, TOPIC, FLOAT64 = 'bags/temperature', '/temperature', 'std_msgs/msg/Float64'
LEAST = 20
# How much the temperature of the lesson's weather station rises from one message to the next.
STEP = 0.5

TOO_FEW = WORDS.mistake('one_topic/ended-too-early')
LEFT_OUT = WORDS.mistake('one_topic/left-out')
TWICE = WORDS.mistake('one_topic/twice')
STEPS_BACK = WORDS.mistake('one_topic/steps-back')
MCAP = WORDS.mistake('one_topic/mcap')


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
    words=WORDS,
    clauses=(
        IsThere(PATH),
        OnlyTopic(TOPIC, FLOAT64),
        Asked(WORDS.of(least=LEAST).clause('enough'), _enough),
        Asked(WORDS.clause('storage'), _storage),
    ),
    stage=InABag(PATH, TOPIC),
    given={'/weather': 'weather'},
)
