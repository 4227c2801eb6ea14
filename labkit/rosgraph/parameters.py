"""Parameters as data: the names of their types, values from text, files of parameters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rclpy.parameter import Parameter as NodeParameter
from rclpy.parameter import get_parameter_value, parameter_value_to_python

from labkit.errors import LabError

__all__ = ['NOT_SET', 'parameters_in', 'python_value', 'to_yaml', 'type_word', 'value_from']

NOT_SET = 'not set'
_WORDS = {
    ParameterType.PARAMETER_NOT_SET: NOT_SET,
    ParameterType.PARAMETER_BOOL: 'boolean',
    ParameterType.PARAMETER_INTEGER: 'integer',
    ParameterType.PARAMETER_DOUBLE: 'double',
    ParameterType.PARAMETER_STRING: 'string',
    ParameterType.PARAMETER_BYTE_ARRAY: 'byte array',
    ParameterType.PARAMETER_BOOL_ARRAY: 'boolean array',
    ParameterType.PARAMETER_INTEGER_ARRAY: 'integer array',
    ParameterType.PARAMETER_DOUBLE_ARRAY: 'double array',
    ParameterType.PARAMETER_STRING_ARRAY: 'string array',
}


def type_word(kind: int) -> str:
    """Return the name of a type of parameters, such as `'integer'`, given its number."""
    return _WORDS[kind]


def python_value(value: ParameterValue) -> Any:
    """Return the value of a parameter as Python has it, None if it is not set."""
    return parameter_value_to_python(value)


def value_from(text: str) -> ParameterValue:
    """Return a value of the type that a text looks like; a text that is not YAML is a string."""
    try:
        return get_parameter_value(text)
    except (yaml.YAMLError, AssertionError, ValueError, RecursionError):
        return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=text)


def to_yaml(node_name: str, values: Mapping[str, ParameterValue]) -> str:
    """Return the parameters of a node as a file of parameters.

    Args:
        node_name: Full name of the node.
        values: Name -> value. A point in a name begins a group.
    """
    tree: dict[str, Any] = {}
    for name, value in values.items():
        *groups, last = name.split('.')
        branch = tree
        for group in groups:
            branch = branch.setdefault(group, {})
        branch[last] = python_value(value)
    text: str = yaml.safe_dump({node_name: {'ros__parameters': tree}}, default_flow_style=False)
    return text


def parameters_in(path: str, node_name: str, *, wildcard: bool = True) -> dict[str, Parameter]:
    """Return the parameters that a file has for a node, by their names.

    Args:
        path: The file.
        node_name: Full name of the node.
        wildcard: Whether those that are for every node count too.

    Raises:
        LabError: It can't be read, is no file of parameters, or has none for this node.
    """
    try:
        values = _values_in(path, node_name, wildcard)
        make: Any = NodeParameter
        return {key: make(key, value=value).to_parameter_msg() for key, value in values.items()}
    except OSError as error:
        raise LabError(f'{path} can not be read: {error.strerror}') from error
    except (yaml.YAMLError, AttributeError, TypeError, ValueError, RecursionError) as error:
        raise LabError(
            f'{path} is no file of parameters: {str(error).splitlines()[0]}',
            todo=f'ros2 param dump {node_name} shows what such a file looks like.',
        ) from error


def _values_in(path: str, node_name: str, wildcard: bool) -> dict[str, Any]:
    nodes = yaml.safe_load(Path(path).read_text(encoding='utf-8')) or {}
    if not isinstance(nodes, dict):
        raise ValueError(f'it has no names of nodes, but {nodes!r}')
    keys = [key for key in ('/**', node_name) if key in nodes and (wildcard or key == node_name)]
    # The words of rclpy's own reader, which is not strict enough: it takes what is for any node.
    if not nodes:
        raise LabError('Param file does not contain selected parameters')
    if not keys:
        raise LabError(
            f'Param file does not contain parameters for {node_name}, only for nodes: '
            f'{list(nodes)}'
        )
    values: dict[str, Any] = {}
    for key in keys:
        if not isinstance(nodes[key], dict) or 'ros__parameters' not in nodes[key]:
            raise LabError(f'YAML file is not a valid ROS parameter file for node {key}')
        values.update(_flat(nodes[key]['ros__parameters']))
    return values


def _flat(tree: dict[str, Any], start: str = '') -> Iterator[tuple[str, Any]]:
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from _flat(value, f'{start}{key}.')
        else:
            yield f'{start}{key}', value
