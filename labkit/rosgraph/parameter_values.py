"""Parameters as data: type names, values from text, parameter files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rclpy.parameter import Parameter as NodeParameter
from rclpy.parameter import get_parameter_value, parameter_value_to_python

from labkit.errors import LabError, did_you_mean, quoted
from labkit.rosgraph.parameter_files import flat, is_meant, sections_in
from labkit.rosgraph.yaml_loading import load_yaml_file

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
    """Return the name of a parameter type, such as `'integer'`."""
    return _WORDS[kind]


def python_value(value: ParameterValue) -> Any:
    """Return the value of a parameter in Python, None if it is not set."""
    return parameter_value_to_python(value)


def value_from(text: str) -> ParameterValue:
    """Return a value of the type that a text looks like; a string if it is not YAML."""
    try:
        return get_parameter_value(text)
    except (yaml.YAMLError, AssertionError, ValueError, RecursionError):
        return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=text)


def to_yaml(node_name: str, values: Mapping[str, ParameterValue]) -> str:
    """Return the parameters of a node as a parameter file.

    Args:
        node_name: Full name of the node.
        values: Name -> value. Dots in names separate groups, down to one that has the name of a
            parameter: its names keep their dots, which the readers of parameter files take, too.
    """
    tree: dict[str, Any] = {}
    for name, value in values.items():
        parts = name.split('.')
        deepest = range(1, len(parts))
        taken = next((end for end in deepest if '.'.join(parts[:end]) in values), len(parts))
        branch = tree
        for group in parts[: taken - 1]:
            branch = branch.setdefault(group, {})
        branch['.'.join(parts[taken - 1 :])] = python_value(value)
    text: str = yaml.safe_dump({node_name: {'ros__parameters': tree}}, default_flow_style=False)
    return text


def parameters_in(path: str, node_name: str, *, wildcard: bool = True) -> dict[str, Parameter]:
    """Return the parameters that a file has for a node, by name.

    Args:
        path: The file.
        node_name: Full name of the node.
        wildcard: Whether to include those for every node.

    Raises:
        LabError: The file can't be read, is not a parameter file, or has none for this node.
    """
    try:
        values = _values_in(path, node_name, wildcard)
        return {key: _message(key, value) for key, value in values.items()}
    except OSError as error:
        raise LabError(f'{path} can not be read: {error.strerror}') from error
    except (AttributeError, TypeError, ValueError) as error:
        raise LabError(
            f'{path} is no file of parameters: {error}',
            todo=f'ros2 param dump {node_name} shows what such a file looks like.',
        ) from error


def _message(name: str, value: Any) -> Parameter:
    make: Any = NodeParameter
    try:
        found: Parameter = make(name, value=value).to_parameter_msg()
    except AssertionError as error:  # an integer of more than 64 bits
        raise ValueError(f'{name} can not be {quoted(value)}. {error}') from error
    return found


def _values_in(path: str, node_name: str, wildcard: bool) -> dict[str, Any]:
    nodes = load_yaml_file(path) or {}
    if not isinstance(nodes, dict):
        raise ValueError(f'it has no names of nodes, but {quoted(nodes)}')
    # The wording of rclpy's own reader, which is not strict enough: it takes those for any node.
    if not nodes:
        raise LabError('Param file does not contain selected parameters')
    sections = list(sections_in(nodes))
    found = [(name, tree) for name, tree in sections if is_meant(name, node_name)]
    if not wildcard:
        found = [(name, tree) for name, tree in found if '*' not in name]
        if all(name == '/**' for name, _ in sections):
            raise LabError(
                'Param file does not contain selected parameters',
                todo='It has some for all nodes, which --no-use-wildcard leaves out.',
            )
    if not found:
        raise LabError(
            f'Param file does not contain parameters for {node_name}, only for nodes: '
            f'{quoted(list(nodes))}',
            todo=did_you_mean(node_name, [name for name, _ in sections]),
        )
    values: dict[str, Any] = {}
    for name, tree in sorted(found, key=lambda section: '*' not in section[0]):
        if tree is None:
            raise LabError(f'YAML file is not a valid ROS parameter file for node {name}')
        values.update(flat(tree))
    return values
