"""Exercise: a lamp that is switched by a service, and says whether that changed anything."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from labkit.exercises import Exercise, Fail, Mistake, Solution
from labkit.exercises.clauses import Call, Named, Responds, Serves, Words
from labkit.exercises.draws import MANY
from labkit.exercises.judging import naming

__all__ = ['exercise']

NODE, SERVICE = '/lamp', '/switch_lamp'
SET_BOOL = 'std_srvs/srv/SetBool'


_STATE = 'request.data != self.is_on'
_MESSAGE = "        response.message = 'on' if self.is_on else 'off'\n"
_COMPARE = 'Compare request.data with self.is_on before you change self.is_on.'
ALWAYS = Mistake(
    'lamp/always',
    'success is always {success}. It has to tell whether this request has changed the lamp.',
    _COMPARE,
    change=[(_STATE, 'True')],
)
AS_ASKED = Mistake(
    'lamp/as-asked',
    'success says what was asked for. Nothing is compared with how the lamp was before, or the '
    'node has not remembered that.',
    _COMPARE,
    change=[(_STATE, 'request.data')],
)
REVERSED = Mistake(
    'lamp/reversed',
    'success is True where nothing has changed, and False where something has.',
    _COMPARE,
    change=[(_STATE, 'request.data == self.is_on')],
)
PARTLY = Mistake(
    'lamp/partly',
    'success is right for some requests only. It has to compare each one with the state.',
    _COMPARE,
)
_SET = "Set it after the state has changed: 'on' if self.is_on else 'off'"
BEFORE = Mistake(
    'lamp/before',
    'It says how the lamp was before, or the opposite of what was asked for.',
    _SET,
    change=[
        (_MESSAGE, ''),
        (
            '        self.is_on = request.data\n',
            f'{_MESSAGE}        self.is_on = request.data\n',
        ),
    ],
)
EMPTY = Mistake(
    'lamp/empty',
    'The message is empty: nothing was put into response.message.',
    _SET,
    change=[(_MESSAGE, '')],
)
EXACTLY = Mistake(
    'lamp/exactly',
    'The message says how the lamp is after the request, in one word: exactly on or off. Capital '
    'letters and spaces count.',
    _SET,
    change=[("'on' if self.is_on else 'off'", "'On' if self.is_on else 'Off'")],
)

_TELLS_CHANGES = Words('`success` is `True` only if that is a change')


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
    name='lamp',
    task='Serve /switch_lamp (SetBool), and tell whether the lamp has changed, and how it is now.',
    clauses=(
        Named(NODE),
        Serves(SERVICE, SET_BOOL, by=NODE),
        Responds(
            SERVICE,
            'each request switches the lamp on (`data` is `True`) or off, and `message` says '
            'which: `on` or `off`',
            _draw,
            _judge,
        ),
        _TELLS_CHANGES,
    ),
    hints=[
        'The node has to remember whether the lamp is on: an attribute of self.',
        "create_service(SetBool, 'switch_lamp', self.on_switch), and on_switch gets request and "
        'response.',
        'First compare: response.success = request.data != self.is_on. Then change, then return '
        'response.',
    ],
    answer=Solution(
        __file__,
        'lamp.py',
        'The response is compared with the state before the state changes. The callback returns '
        'at once, so two requests that come together are answered one after the other.',
    ),
)
