"""Exercise: a lamp that is switched by a service, and says whether that changed anything."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from labkit.exercises import Exercise, Fail, Mistake, words_of
from labkit.exercises.clauses import Call, Named, Responds, Serves, Words
from labkit.exercises.draws import MANY
from labkit.exercises.judging import naming

__all__ = ['exercise']

WORDS = words_of(__file__)

NODE, SERVICE = '/lamp', '/switch_lamp'
SET_BOOL = 'std_srvs/srv/SetBool'

ALWAYS = WORDS.mistake('lamp/always')
AS_ASKED = WORDS.mistake('lamp/as-asked')
REVERSED = WORDS.mistake('lamp/reversed')
PARTLY = WORDS.mistake('lamp/partly')
BEFORE = WORDS.mistake('lamp/before')
EMPTY = WORDS.mistake('lamp/empty')
EXACTLY = WORDS.mistake('lamp/exactly')

_TELLS_CHANGES = Words(WORDS.clause('tells-changes'))


def _draw() -> Sequence[Sequence[Mapping[str, Any]]]:
    """Return many requests in which changes and repetitions are, alone and two at once."""
    value = random.choice([True, False])
    one = [value, value, not value, not value, not value, value, not value]
    one += [*random.choices([True, False], k=MANY), not value]
    groups = [[{'data': data}] for data in one]
    return [*groups, [{'data': value}, {'data': value}], [{'data': not value}], [{'data': value}]]


def _word(on: bool) -> str:
    return 'on' if on else 'off'


def _judge(calls: Sequence[Call]) -> None:
    """Judge the responses; how the lamp was before the first call is not known."""
    for call in calls:
        asked, seen = call.request['data'], call.response.message
        if seen != _word(asked):
            raise Fail(
                f'message = {_word(asked)!r} for the request data = {asked}',
                f'message = {seen!r}',
                BEFORE if seen == _word(not asked) else EXACTLY if seen else EMPTY,
            )
    for before, call in pairwise(calls):
        asked, was = call.request['data'], before.request['data']
        if call.response.success != (asked != was):
            with naming(_TELLS_CHANGES):
                raise Fail(
                    f'success = {asked != was} for data = {asked}, while the lamp is {_word(was)}',
                    f'success = {call.response.success}',
                    _success_trouble(calls),
                )


def _success_trouble(calls: Sequence[Call]) -> Mistake:
    """Return what success stands for, if it is not whether the lamp has changed."""
    asked = [call.request['data'] for call in calls]
    seen = [call.response.success for call in calls]
    if len({*seen}) == 1:
        return ALWAYS.of(success=seen[0])
    if seen == asked:
        return AS_ASKED
    same = [now == was for was, now in pairwise(asked)]
    return REVERSED if seen[1:] == same else PARTLY


exercise = Exercise(
    words=WORDS,
    clauses=(
        Named(NODE),
        Serves(SERVICE, SET_BOOL, by=NODE),
        Responds(
            SERVICE,
            WORDS.clause('responds'),
            _draw,
            _judge,
        ),
        _TELLS_CHANGES,
    ),
)
