"""What a parameter file says, and for which nodes. Nothing here needs rclpy."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

__all__ = ['flat', 'is_meant', 'sections_in']


def sections_in(tree: Mapping[Any, Any], start: str = '') -> Iterator[tuple[str, Any]]:
    """Yield the full name of each node in a parameter file, and what it has for that.

    As in rcl, the slash at the beginning of a name may be left out, a name may have wildcards
    (see `is_meant`), and namespaces may be groups of nodes. What a file has for a node is None
    where `ros__parameters` is missing.
    """
    for key, value in tree.items():
        name = f'{start}/{str(key).strip("/")}'
        inner = value if isinstance(value, Mapping) else {}
        groups = {key: each for key, each in inner.items() if key != 'ros__parameters'}
        is_group = bool(groups) and all(isinstance(each, Mapping) for each in groups.values())
        if 'ros__parameters' in inner or not is_group:
            yield name, inner.get('ros__parameters')
        if is_group:
            yield from sections_in(groups, name)


def is_meant(name: str, node_name: str) -> bool:
    """Return whether a name in a parameter file means a node: `*` is one part, `**` any number."""
    parts = {'**': '(/[^/]+)*', '*': '/[^/]+'}
    words = name.strip('/').split('/')
    pattern = ''.join(parts.get(word, f'/{re.escape(word)}') for word in words)
    return re.fullmatch(pattern, node_name) is not None


def flat(tree: Mapping[Any, Any], start: str = '') -> Iterator[tuple[str, Any]]:
    """Yield the name of each parameter, with its groups and dots before it, and its value."""
    for key, value in tree.items():
        if isinstance(value, Mapping):
            yield from flat(value, f'{start}{key}.')
        else:
            yield f'{start}{key}', value
