"""Changes to commands such as `%ros2 topic pub --once /odds std_msgs/msg/Int16 "{data: 1}"`."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator

from mutants.changes import SIBLINGS, misspelt, other_values

__all__ = ['command_changes']

# A word, or a text in quotation marks; a line may go on after a backslash.
_WORD = re.compile(r'"[^"]*"|[^\s\\]\S*')
_NUMBER = re.compile(r'(?<![\w.])\d+(?:\.\d+)?(?![\w.])')
_NAME = re.compile(r'(?<![a-zA-Z])[a-zA-Z]\w*')
_OTHER_TYPES = {
    'std_msgs/msg/Int16': ('std_msgs/msg/Int32', 'std_msgs/msg/UInt16', 'std_msgs/msg/String'),
    'geometry_msgs/msg/Twist': ('geometry_msgs/msg/TwistStamped', 'geometry_msgs/msg/Vector3'),
}


def command_changes(code: str) -> Iterator[tuple[str, str]]:
    """Give lines of commands with one change each: its kind, and the lines."""
    yield from _numbers_and_names(code)
    yield from _words(code)
    yield from _commands(code)
    for old, new in (('%', ''), ('"', ''), ('"', "'"), (': ', ':'), (': ', '='), ('{', '[')):
        yield 'text', code.replace(old, new, 1)
        yield 'text', code.replace(old, new)
    yield 'option', code.replace('--once', '--times 2', 1)
    yield 'option', code.replace('--rate', '--wait')


def _put(code: str, found: re.Match[str], new: str) -> str:
    return code[: found.start()] + new + code[found.end() :]


def _numbers_and_names(code: str) -> Iterator[tuple[str, str]]:
    for found in _NUMBER.finditer(code):
        text = found.group()
        for value in other_values(float(text) if '.' in text else int(text)):
            yield 'constant', _put(code, found, str(value))
    for found in _NAME.finditer(code):
        yield 'name', _put(code, found, misspelt(found.group()))
        if found.group() in SIBLINGS:
            yield 'other-name', _put(code, found, SIBLINGS[found.group()])
    for old, others in _OTHER_TYPES.items():
        for other in others:
            yield 'type', code.replace(old, other, 1)
            yield 'type', code.replace(old, other)


def _words(code: str) -> Iterator[tuple[str, str]]:
    words = list(_WORD.finditer(code))
    for word in words:
        yield 'removed', _put(code, word, '')
    for first, second in itertools.pairwise(words):
        if '%' not in second.group():
            swapped = _put(_put(code, second, first.group()), first, second.group())
            yield 'arguments', swapped


def _commands(code: str) -> Iterator[tuple[str, str]]:
    """Leave out, exchange, and repeat whole commands."""
    commands = [f'%{command}' for command in code.split('%')[1:]]
    for i, command in enumerate(commands):
        rest = ''.join(commands[:i] + commands[i + 1 :])
        yield 'removed', rest or 'pass'
        yield 'twice', ''.join([*commands[: i + 1], '\n', *commands[i:]])
        if i:
            order = [*commands[: i - 1], command, '\n', commands[i - 1], *commands[i + 1 :]]
            yield 'order', ''.join(order)
