"""How a type is defined, with all types within it, in the words that rosbag2 stores."""

from __future__ import annotations

import functools
import re

from rosidl_adapter.parser import parse_message_string  # type: ignore[import-untyped]

from labkit.rosgraph import interfaces

__all__ = ['ENCODING', 'full_definition']

ENCODING = 'ros2msg'
_LINE = '=' * 80


@functools.cache
def full_definition(msg_type: str) -> str:
    """Return the definition of a type and, after a line each, of the types within it.

    Args:
        msg_type: Full name of a message type that is installed.

    Raises:
        OSError: Its definition is not where it should be.
    """
    text = _text_of(msg_type)
    found, waiting = [text], _within(msg_type, text)
    known = {msg_type, *waiting}
    while waiting:
        name = waiting.pop(0)
        text = _text_of(name)
        # As rosbag2 has it, a message has no `msg` in its name; what it is a part of stays.
        found.append(f'{_LINE}\nMSG: {name.replace("/msg/", "/")}\n{text}')
        more = [other for other in _within(name, text) if other not in known]
        known.update(more)
        waiting += more
    return '\n'.join(found)


def _text_of(name: str) -> str:
    if not interfaces.is_part_of_action(name):
        return interfaces.path_of(name).read_text(encoding='utf-8')
    action, _, part = name.rpartition('_')
    if part == 'FeedbackMessage':
        return f'unique_identifier_msgs/UUID goal_id\n{action}_Feedback feedback\n'
    text = interfaces.path_of(action).read_text(encoding='utf-8')
    goal, result, feedback = re.split(r'(?m)^---\s*$', text)
    return {'Goal': goal, 'Result': result, 'Feedback': feedback}[part].lstrip('\n')


def _within(name: str, text: str) -> list[str]:
    """Return the names of the types of a definition's fields."""
    if name.endswith('_FeedbackMessage'):
        return ['unique_identifier_msgs/msg/UUID', f'{name.removesuffix("Message")}']
    package, _, word = name.split('/')
    fields = parse_message_string(package, word.replace('_', ''), text).fields
    found = [
        f'{field.type.pkg_name}/msg/{field.type.type}' for field in fields if field.type.pkg_name
    ]
    return list(dict.fromkeys(found))
