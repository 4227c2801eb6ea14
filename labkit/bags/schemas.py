"""Definitions of types with all nested types, in the form that rosbag2 stores."""

from __future__ import annotations

import functools
import re

from rosidl_adapter.parser import parse_message_string  # type: ignore[import-untyped]

from labkit.rosgraph import interfaces

__all__ = ['ENCODING', 'full_definition']

ENCODING = 'ros2msg'
_LINE = '=' * 80
# Parts of actions and services that no file defines.
_MADE = {
    'FeedbackMessage': ['unique_identifier_msgs/UUID goal_id', '{}_Feedback feedback'],
    'Event': [
        'service_msgs/ServiceEventInfo info',
        '{}_Request[<=1] request',
        '{}_Response[<=1] response',
    ],
}


@functools.cache
def full_definition(msg_type: str) -> str:
    """Return the definition of a type, followed by those of nested types.

    Args:
        msg_type: Full name of an installed message type.

    Raises:
        OSError: The definition file is missing.
    """
    text = _text_of(msg_type)
    found, waiting = [text], _within(msg_type, text)
    known = {msg_type, *waiting}
    while waiting:
        name = waiting.pop(0)
        text = _text_of(name)
        # rosbag2 omits `msg` from the names of messages, but keeps parts of actions.
        found.append(f'{_LINE}\nMSG: {name.replace("/msg/", "/")}\n{text}')
        more = [other for other in _within(name, text) if other not in known]
        known.update(more)
        waiting += more
    return '\n'.join(found)


def _text_of(name: str) -> str:
    if not interfaces.is_part(name):
        return interfaces.path_of(name).read_text(encoding='utf-8')
    whole, _, part = name.rpartition('_')
    if part in _MADE:
        return ''.join(f'{line.format(whole)}\n' for line in _MADE[part])
    text = interfaces.path_of(whole).read_text(encoding='utf-8')
    names = ('Goal', 'Result', 'Feedback') if '/action/' in name else ('Request', 'Response')
    parts = re.split(r'(?m)^---\s*$', text)
    return dict(zip(names, parts, strict=True))[part].lstrip('\n')


def _within(name: str, text: str) -> list[str]:
    """Return the names of the message types of a definition's fields."""
    whole, _, part = name.rpartition('_')
    if part in _MADE:
        types = [re.split(r'[\[ ]', line.format(whole))[0] for line in _MADE[part]]
        return [each if each.count('/') == 2 else each.replace('/', '/msg/') for each in types]
    package, _, word = name.split('/')
    fields = parse_message_string(package, word.replace('_', ''), text).fields
    found = [
        f'{field.type.pkg_name}/msg/{field.type.type}' for field in fields if field.type.pkg_name
    ]
    return list(dict.fromkeys(found))
