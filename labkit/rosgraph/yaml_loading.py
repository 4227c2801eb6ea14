"""YAML that somebody else has written: the safe loader, with limits."""

from __future__ import annotations

from typing import Any

import yaml

from labkit.files import AnyPath, read_limited

__all__ = ['load_yaml', 'load_yaml_file']

# Most values that aliases may repeat: ten lines of them can stand for billions.
MAX_REPEATED = 10_000


def load_yaml(text: str, loader_class: type[yaml.SafeLoader] = yaml.SafeLoader) -> Any:
    """Return the data of a YAML document.

    Raises:
        ValueError: It is not YAML, nested too deep, or its aliases repeat too much. The message
            tells the problem in a few words.
    """
    try:
        loader = loader_class(text)
        root = loader.get_single_node()
        if root is None:
            return None
        sizes: dict[int, int] = {}
        if _size(root, sizes) - len(sizes) > MAX_REPEATED:
            raise ValueError('its aliases repeat too many values')
        return loader.construct_document(root)
    except RecursionError as error:
        raise ValueError('it is nested too deep') from error
    except Exception as error:  # a library, and data from anywhere
        # Of a number with too many digits, Python tells after a semicolon how to allow them.
        problem = getattr(error, 'problem', None) or str(error).partition(';')[0]
        raise ValueError(str(problem).partition('\n')[0]) from error


def load_yaml_file(path: AnyPath) -> Any:
    """Return the data of a YAML file. See `load_yaml` and `read_limited`.

    Raises:
        OSError: It can't be read, is too large, or is not a regular file.
        ValueError: It is not YAML that can be taken.
    """
    return load_yaml(read_limited(path).decode())


def _size(node: yaml.Node, sizes: dict[int, int]) -> int:
    """Return the number of values in a node, aliases written out; note it for each node once."""
    if id(node) not in sizes:
        sizes[id(node)] = MAX_REPEATED + 1  # for a node within itself, which has no end
        children = node.value if isinstance(node, yaml.CollectionNode) else ()
        if isinstance(node, yaml.MappingNode):
            children = [each for pair in children for each in pair]
        sizes[id(node)] = 1 + sum(_size(each, sizes) for each in children)
    return sizes[id(node)]
