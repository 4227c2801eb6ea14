"""Refuse arguments that rclpy blames on something else, notices late, or dies of.

An action made with the type of a message ends the process. A callback of `None` is found when the
timer is due, and the response of a service that is none has a `TypeError` without a word.
"""

from __future__ import annotations

import ast
import inspect
import re
import types
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from labkit.background import compat
from labkit.background.tracebacks import argument_at_caller
from labkit.errors import LabError, cell_name, quoted
from labkit.rosgraph.interfaces import type_name

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = [
    *('check_args', 'check_callback', 'check_name', 'check_response', 'check_sent', 'check_type'),
    'one_type',
]

_OTHER_TYPE = re.compile(
    r'existing request topic name rq(/\S+?)(/_action/send_goal)?Request with incompatible type'
)
_EXAMPLES = {
    'message': 'String of std_msgs.msg',
    'service': 'Trigger of std_srvs.srv',
    'action': 'Fibonacci of test_msgs.action',
}


def check_type(function: str, kind: str, given: Any) -> None:
    """Refuse what is not the class of a message, service or action.

    Args:
        function: The function that gets it.
        kind: The kind that it needs.
        given: The argument.
    """
    found = _kind(given)
    if found == kind:
        return
    todo = f'Pass the class of {_a(kind)}, such as {_EXAMPLES[kind]}.'
    if isinstance(given, str):
        name = re.fullmatch(r'(\w+)/(msg|srv|action)/(\w+)', given)
        seen = f'the text {given[:60]!r}'
        if name:
            todo = f'Import the class, and pass it: from {name[1]}.{name[2]} import {name[3]}'
    elif found:
        cls = given if isinstance(given, type) else type(given)
        seen = f'{type_name(cls)}, which is {_a(found)}'
        action, _, part = cls.__name__.rpartition('_')
        if kind == 'action' and action and '.action.' in cls.__module__:
            todo = f'Pass the action itself: {action}, not {action}.{part}.'
    else:
        seen = _shown(given)
    raise LabError(f'{function}() expects the class of {_a(kind)}, but got {seen}.', todo=todo)


def check_name(function: str, given: Any, example: str) -> None:
    """Refuse a name that is no text: rclpy quotes the signature of its own function in C."""
    if not isinstance(given, str):
        raise LabError(
            f'{function}() expects a name, a text in quotes, but got {_shown(given)}.',
            todo=f'Write it in its place, in quotes, such as {example!r}.',
        )


def check_args(function: str, name: str, given: Any) -> None:
    """Refuse arguments for ROS in one text: rcl takes none of its letters, and says nothing."""
    if isinstance(given, (str, bytes)):
        raise LabError(
            f'{function}({name}=...) expects a list of words, but got one text, {quoted(given)}.',
            todo=f"Write a list: {name}=['--ros-args', '-r', 'chatter:=news']",
        )


@contextmanager
def one_type(node: Node | None, asked: type) -> Iterator[None]:
    """Say in a `with` block that a service or an action is there with another type.

    Args:
        node: A node to ask the graph with.
        asked: The class of the service or action that is made in the block.
    """
    try:
        yield
    except (compat.RCLError, ValueError) as error:
        found = _OTHER_TYPE.search(str(error))
        if found is None or node is None:
            raise
        name, action = found[1], found[2] or ''
        types = dict(node.get_service_names_and_types()).get(f'{name}{action}', ['another type'])
        had = ' and '.join(each.removesuffix('_SendGoal') for each in types)
        what = 'an action' if action else 'a service'
        raise LabError(
            f'{name} is {what} of {had} in this notebook already, and not of {type_name(asked)}. '
            f'In one notebook, {what} has one type.',
            todo=f'Use the same type at both ends, or another name than {name!r}.',
        ) from error


def check_callback(function: str, callback: Any, position: int, name: str = 'callback') -> None:
    """Refuse a callback that can't be called.

    Args:
        function: The function that gets it.
        callback: The argument.
        position: Its position in the learner's line.
        name: Its name there.
    """
    if callable(callback):
        return
    written = argument_at_caller(function, position, name)
    what = f'{function}() expects a function as its {name}, but got {_shown(callback)}'
    if not isinstance(written, ast.Call):
        raise LabError(f'{what}.', todo='Pass the name of a function or of a method.')
    raise LabError(
        f'{what}: with brackets, {ast.unparse(written)} calls it at once, and passes on what it '
        'returns.',
        todo=f'Pass the name alone, without brackets: {ast.unparse(written.func)}',
    )


def check_sent(function: str, given: Any, cls: type, part: str) -> None:
    """Refuse a request or a goal of another type.

    Args:
        function: The function that sends it.
        given: The argument.
        cls: The class of the service or action.
        part: `'Request'` or `'Goal'`.
    """
    if isinstance(given, getattr(cls, part)):
        return
    needed = f'{cls.__name__}.{part}'
    if given is getattr(cls, part):
        raise LabError(
            f'{needed} is the class; {function}() sends an object made of it.',
            todo=f'Make one first, with brackets: {needed}()',
        )
    raise LabError(
        f'{function}() expects an object of {needed}, but got {_shown(given)}.',
        todo=f'Make one first, such as {needed}(), and pass it.',
    )


def check_response(service: Any, response: Any) -> None:
    """Refuse what the callback of a service has returned if it is no response."""
    if isinstance(response, service.srv_type.Response):
        return
    callback = service.callback
    code = getattr(inspect.unwrap(callback), '__code__', None)
    name = getattr(callback, '__name__', type(callback).__name__)
    place = ''
    if code is not None:
        file = cell_name(code.co_filename) or code.co_filename
        place = f' ({file}, line {code.co_firstlineno})'
    raise LabError(
        f'{name}{place} returned {_shown(response)}. The callback of a service returns the '
        f'response, an object of {service.srv_type.__name__}.Response.',
        todo='End the callback with: return response',
    )


def _kind(given: Any) -> str:
    """Return whether something is a message, a service or an action; '' if none of them."""
    if not isinstance(given, type):
        # rclpy takes an object for the class of a message.
        return 'message' if hasattr(given, 'get_fields_and_field_types') else ''
    if all(hasattr(given, part) for part in ('Goal', 'Result', 'Feedback')):
        return 'action'
    if hasattr(given, 'Request') and hasattr(given, 'Response'):
        return 'service'
    return 'message' if hasattr(given, 'get_fields_and_field_types') else ''


def _a(kind: str) -> str:
    return f'{"an" if kind[0] in "aeiou" else "a"} {kind}'


def _shown(value: Any) -> str:
    if isinstance(value, types.ModuleType):
        return f'the module {value.__name__}'
    text = repr(value)
    return text if len(text) <= 60 else f'{text[:57]}...'
