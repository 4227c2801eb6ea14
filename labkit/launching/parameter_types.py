"""Types of parameters: what a text becomes, by the rules of YAML or by a named type."""

from __future__ import annotations

from typing import Any

from labkit.errors import did_you_mean
from labkit.launching.model import LaunchError
from labkit.rosgraph.yaml_loading import load_yaml

__all__ = ['TYPES', 'coerce', 'is_value', 'type_named']

Value = bool | int | float | str | list[Any]
SCALARS: dict[str, type] = {'str': str, 'bool': bool, 'float': float, 'int': int}
TYPES = (*SCALARS, *(f'list_of_{name}' for name in SCALARS), 'yaml')


def type_named(name: str) -> str:
    """Return the type of an attribute `type`, `''` for the rules of YAML.

    Raises:
        LaunchError: There is no such type.
    """
    if name not in TYPES:
        raise LaunchError(
            f'There is no type {name!r}.',
            todo=did_you_mean(name, TYPES, f'There are: {", ".join(TYPES)}.'),
        )
    return '' if name == 'yaml' else name


def coerce(text: str, kind: str = '') -> Value:
    """Return a text as a value.

    Args:
        text: The text.
        kind: One of `TYPES`; `''` decides by the rules of YAML.

    Raises:
        LaunchError: It is no value of that type.
    """
    if kind == 'str' or (not text and not kind):
        return text
    if kind in ('int', 'float'):
        try:
            return SCALARS[kind](text)  # type: ignore[no-any-return]
        except ValueError:
            raise _wrong(text, kind) from None
    if kind == 'bool':
        text = {'1': 'true', '0': 'false'}.get(text, text)
    try:
        value = load_yaml(text)
    except ValueError as error:
        raise _wrong(text, kind) from error
    if not is_value(value, kind):
        raise _wrong(text, kind)
    return value  # type: ignore[no-any-return]


def is_value(value: Any, kind: str = '') -> bool:
    """Return whether a value is of a type; of any that a parameter may have if `kind` is `''`."""
    if kind.startswith('list_of_'):
        item = SCALARS[kind.removeprefix('list_of_')]
        return isinstance(value, list) and all(isinstance(one, item) for one in value)
    if kind:
        return isinstance(value, SCALARS[kind])
    if isinstance(value, list):
        first = type(value[0]) if value else str
        return first in SCALARS.values() and all(isinstance(one, first) for one in value)
    return type(value) in SCALARS.values()


def _wrong(text: str, kind: str) -> LaunchError:
    if not kind:
        return LaunchError(
            f'{text!r} is no value of a parameter.',
            todo='It may be a number, true, false, a text, or a list of one of these: [1, 2]. '
            'For a text with special characters: type="str"',
        )
    return LaunchError(f'{text!r} is no value of the type {kind}.')
