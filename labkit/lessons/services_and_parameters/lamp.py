"""Exercise: a lamp that is switched by a service, and says whether that changed anything."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NoReturn

from labkit.exercises import Exercise, Fail, Outcome, Solution, Style, Wrong, changed
from labkit.exercises.clauses import Call, Named, Responds, Serves
from labkit.lessons._script import in_process, started_by_subprocess

__all__ = ['lamp']

SERVICE = '/switch_lamp'
SET_BOOL = 'std_srvs/srv/SetBool'

_LAMP = """
from rclpy.node import Node
from std_srvs.srv import SetBool


class Lamp(Node):
    def __init__(self):
        super().__init__('lamp')
        self.service = self.create_service(SetBool, 'switch_lamp', self.on_switch)
        self.is_on = False

    def on_switch(self, request, response):
        response.success = request.data != self.is_on
        self.is_on = request.data
        response.message = 'on' if self.is_on else 'off'
        return response


lab.spin(Lamp())
"""
_THREAD = """
import threading

import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_srvs.srv import SetBool

node = rclpy.create_node('lamp')
state = {'on': False}


def on_switch(request, response):
    response.success = state['on'] is not request.data
    state['on'] = request.data
    response.message = ('off', 'on')[request.data]
    return response


node.create_service(SetBool, '/switch_lamp', on_switch)
executor = SingleThreadedExecutor()
executor.add_node(node)
threading.Thread(target=executor.spin, daemon=True).start()
"""


def _draw() -> Sequence[Sequence[Mapping[str, Any]]]:
    """Return requests in which changes and repetitions are, alone and two at once."""
    value = random.choice([True, False])
    one = [value, value, not value, not value, not value, value, not value]
    groups = [[{'data': data}] for data in one]
    return [*groups, [{'data': value}, {'data': value}], [{'data': not value}], [{'data': value}]]


def _word(on: bool) -> str:
    return 'on' if on else 'off'


def _judge(calls: Sequence[Call]) -> None:
    """Judge the responses; how the lamp was before the first call is not known."""
    for call in calls:
        asked, seen = call.request['data'], call.response.message
        if seen != _word(asked):
            _refuse_message(f'the request data = {asked}', asked, seen)
    for before, call in pairwise(calls):
        asked, was = call.request['data'], before.request['data']
        if call.response.success != (asked != was):
            raise Fail(
                f'success = {asked != was} upon data = {asked}, while the lamp is {_word(was)}',
                f'success = {call.response.success}',
                why=_success_trouble(calls),
                todo='Compare request.data with self.is_on before you change self.is_on.',
            )


def _success_trouble(calls: Sequence[Call]) -> str:
    """Say what success stands for, if it is not whether the lamp has changed."""
    seen = [call.response.success for call in calls]
    if len({*seen}) == 1:
        return (
            f'success is always {seen[0]}. It has to tell whether this request has changed the '
            'lamp.'
        )
    if seen == [call.request['data'] for call in calls]:
        return (
            'success says what was asked for. Nothing is compared with how the lamp was before, '
            'or the node has not remembered that.'
        )
    if not any(
        now.response.success == (now.request['data'] != was.request['data'])
        for was, now in pairwise(calls)
    ):
        return 'success is True where nothing has changed, and False where something has.'
    return 'success is right for some requests only. It has to compare each one with the state.'


def _refuse_message(request: str, asked: bool, seen: str) -> NoReturn:
    why = 'The message says how the lamp is after the request, in one word.'
    if seen == _word(not asked):
        why = 'It says how the lamp was before, or the opposite of what was asked for.'
    elif not seen:
        why = 'The message is empty: nothing was put into response.message.'
    elif seen.strip().lower() == _word(asked):
        why = 'Capital letters and spaces count: the word is exactly on or off.'
    raise Fail(
        f'message = {_word(asked)!r} upon {request}',
        f'message = {seen!r}',
        why=why,
        todo="Set it after the state has changed: 'on' if self.is_on else 'off'",
    )


lamp = Exercise(
    name='lamp',
    task='Serve /switch_lamp (SetBool), and tell whether the lamp has changed, and how it is now.',
    serves={SERVICE: SET_BOOL},
    nodes=['/lamp'],
    clauses=(
        Named('/lamp'),
        Serves(SERVICE, SET_BOOL),
        Responds(
            SERVICE,
            'each request switches the lamp on (`data` is `True`) or off; `message` is `on` or '
            '`off`, as the lamp is then, and `success` is `True` only if that is a change',
            _draw,
            _judge,
        ),
    ),
    hints=[
        'The node has to remember whether the lamp is on: an attribute of self.',
        "create_service(SetBool, 'switch_lamp', self.on_switch), and on_switch gets request and "
        'response.',
        'First compare: response.success = request.data != self.is_on. Then change, then return '
        'response.',
    ],
    answer=Solution(
        _LAMP,
        'The response is compared with the state before the state changes. The callback returns '
        'at once, so two requests that come together are answered one after the other.',
    ),
    styles=[
        Style('functions, and an executor of its own', _THREAD),
        Style(
            'if and else',
            changed(
                _LAMP,
                (
                    '        response.success = request.data != self.is_on\n'
                    '        self.is_on = request.data\n',
                    '        if request.data == self.is_on:\n'
                    '            response.success = False\n'
                    '        else:\n'
                    '            response.success = True\n'
                    '            self.is_on = not self.is_on\n',
                ),
            ),
        ),
        Style(
            'a new response, and a coroutine',
            changed(
                _LAMP,
                ('    def on_switch', '    async def on_switch'),
                ('        response.success = request', '        changes = request'),
                (
                    "        response.message = 'on' if self.is_on else 'off'\n"
                    '        return response\n',
                    "        word = 'on' if self.is_on else 'off'\n"
                    '        return SetBool.Response(success=changes, message=word)\n',
                ),
            ),
        ),
        Style('own process, started here', started_by_subprocess(in_process(_LAMP))),
        Style('own process', in_process(_LAMP), process=True),
    ],
    wrong=[
        Wrong(
            'always success',
            changed(_LAMP, ('request.data != self.is_on', 'True')),
            'success is always True',
        ),
        Wrong(
            'success is the request',
            changed(_LAMP, ('request.data != self.is_on', 'request.data')),
            'success says what was asked for',
        ),
        Wrong(
            'compares after the change',
            changed(
                _LAMP,
                (
                    '        response.success = request.data != self.is_on\n'
                    '        self.is_on = request.data\n',
                    '        self.is_on = request.data\n'
                    '        response.success = request.data != self.is_on\n',
                ),
            ),
            'success is always False',
        ),
        Wrong(
            'the opposite',
            changed(_LAMP, ('request.data != self.is_on', 'request.data == self.is_on')),
            'success is True where nothing has changed',
        ),
        Wrong(
            'message before the change',
            changed(
                _LAMP,
                (
                    "        response.message = 'on' if self.is_on else 'off'\n",
                    '',
                ),
                (
                    '        self.is_on = request.data\n',
                    "        response.message = 'on' if self.is_on else 'off'\n"
                    '        self.is_on = request.data\n',
                ),
            ),
            'It says how the lamp was before',
        ),
        Wrong(
            'forgets',
            changed(
                _LAMP, ('        self.is_on = request.data\n', '        on = request.data\n')
            ).replace("'on' if self.is_on", "'on' if on"),
            'or the node has not remembered that',
        ),
        Wrong(
            'no message',
            changed(_LAMP, ("        response.message = 'on' if self.is_on else 'off'\n", '')),
            'The message is empty',
        ),
        Wrong(
            'capital letters',
            changed(_LAMP, ("'on' if self.is_on else 'off'", "'On' if self.is_on else 'Off'")),
            'Capital letters and spaces count',
        ),
        Wrong(
            'toggles',
            changed(
                _LAMP,
                ('        self.is_on = request.data\n', '        self.is_on = not self.is_on\n'),
            ),
            'or the opposite of what was asked for',
        ),
        Wrong(
            'no return',
            changed(_LAMP, ('        return response\n', '')),
            'End the callback with: return response',
            outcome=Outcome.ERROR,
        ),
        Wrong(
            'another name',
            changed(_LAMP, ("'switch_lamp'", "'lamp_switch'")),
            'lamp_switch',
        ),
        Wrong(
            'a private name',
            changed(_LAMP, ("'switch_lamp'", "'~/switch_lamp'")),
            'it lies in another namespace',
        ),
        Wrong(
            'Trigger',
            changed(_LAMP, ('SetBool', 'Trigger'), ('request.data', 'bool(request)')),
            'with the type std_srvs/srv/Trigger',
        ),
        Wrong(
            'another node name',
            changed(_LAMP, ("__init__('lamp')", "__init__('light')")),
            'The name is what super().__init__() gets',
        ),
        Wrong(
            'not spun',
            changed(_LAMP, ('lab.spin(Lamp())', 'Lamp()')),
            'Hand the node over: lab.spin(node)',
        ),
        Wrong(
            'waits in the callback',
            changed(
                _LAMP,
                (
                    '        return response\n',
                    '        import time\n\n        time.sleep(3)\n        return response\n',
                ),
            ),
            'While a callback runs, no other one can',
        ),
        Wrong(
            'always success, in a process of its own',
            changed(in_process(_LAMP), ('request.data != self.is_on', 'True')),
            'success is always True',
            process=True,
        ),
    ],
)
