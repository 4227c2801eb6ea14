"""The text of interface types, including nested ones."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rosidl_adapter.parser import parse_message_string  # type: ignore[import-untyped]

from labkit.rosgraph import interfaces

__all__ = ['definition']


def definition(
    name: str, *, comments: bool = True, nested_comments: bool = False, indent: str = ''
) -> Iterator[str]:
    """Yield the lines of a definition, as the real `ros2 interface show` prints them.

    Args:
        name: Full name of the type.
        comments: Whether to keep comments and empty lines. Without them, a trailing comment keeps
            its sign, with everything before its text.
        nested_comments: The same for types within this one.
        indent: Prefix of each line.
    """
    package, _, word = name.split('/')
    for raw in interfaces.path_of(name).read_text(encoding='utf-8').splitlines():
        text, nested = raw.rstrip(), ''
        if text != '---':
            parsed = parse_message_string(package, word, text)
            if not comments:
                text = _without_comment(text, parsed)
                if not text:
                    continue
            if parsed.fields:
                nested = str(parsed.fields[0].type).partition('[')[0]
        yield f'{indent}{text}' if text else ''
        if '/' in nested:
            yield from definition(
                nested.replace('/', '/msg/'),
                comments=nested_comments,
                nested_comments=nested_comments,
                indent=f'{indent}\t',
            )


def _without_comment(text: str, parsed: Any) -> str:
    """Return a line without its comment; '' if nothing is left."""
    if parsed.annotations['comment']:
        return ''
    for element in [*parsed.fields, *parsed.constants]:
        behind = element.annotations['comment']
        if behind:
            # The text begins one blank after the sign.
            return text[: text.find(behind[0]) - 1].strip()
    return text
