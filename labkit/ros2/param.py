"""`ros2 param`: the parameters of nodes, which every node holds itself."""

from __future__ import annotations

import re
import sys
from argparse import Namespace
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import yaml
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue, SetParametersResult
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.node import Node
from rclpy.parameter import Parameter as NodeParameter
from rclpy.parameter import get_parameter_value, parameter_value_to_python

from labkit.background.service_calls import call_node
from labkit.errors import LabError
from labkit.ros2.asking import add_discovery_options, asking_node, check_node_name, unknown
from labkit.ros2.graph_words import node_names
from labkit.ros2.parser import Command, Parser, Usage, Verb, positive_float
from labkit.rosgraph.names import is_hidden
from labkit.rosgraph.snapshot import node_names as names_of_nodes

__all__ = ['COMMAND']

# Type of a parameter -> its name, and how `get` introduces its value.
_TYPES = {
    ParameterType.PARAMETER_NOT_SET: ('not set', 'Parameter not set.'),
    ParameterType.PARAMETER_BOOL: ('boolean', 'Boolean value is:'),
    ParameterType.PARAMETER_INTEGER: ('integer', 'Integer value is:'),
    ParameterType.PARAMETER_DOUBLE: ('double', 'Double value is:'),
    ParameterType.PARAMETER_STRING: ('string', 'String value is:'),
    ParameterType.PARAMETER_BYTE_ARRAY: ('byte array', 'Byte values are:'),
    ParameterType.PARAMETER_BOOL_ARRAY: ('boolean array', 'Boolean values are:'),
    ParameterType.PARAMETER_INTEGER_ARRAY: ('integer array', 'Integer values are:'),
    ParameterType.PARAMETER_DOUBLE_ARRAY: ('double array', 'Double values are:'),
    ParameterType.PARAMETER_STRING_ARRAY: ('string array', 'String values are:'),
}


def list_parameters(args: Namespace) -> None:
    """Print the names of the parameters of one node or of all."""
    wanted = _pattern(args.filter)
    node = asking_node(args)
    if args.node_name:
        chosen = [check_node_name(node, args.node_name)]
    else:
        offered = dict(node.get_service_names_and_types())
        chosen = [
            name
            for name in dict.fromkeys(names_of_nodes(node))
            if args.include_hidden_nodes or not is_hidden(name)
            if f'{name}/list_parameters' in offered
        ]
    for name in chosen:
        try:
            names = list(filter(wanted.match, _names_of(node, name, args.param_prefixes)))
            types = _types_of(node, name, names) if args.param_type else {}
        except LabError as error:
            print(error, file=sys.stderr)
            continue
        if names and not args.node_name:
            print(f'{name}:')
        for parameter in names:
            kind = f' (type: {types[parameter]})' if parameter in types else ''
            print(f'  {parameter}{kind}')


def _pattern(text: str) -> re.Pattern[str]:
    try:
        return re.compile(text)
    except re.error as error:
        raise Usage(
            f'ros2 param list: {text!r} is no regular expression: {error}.',
            todo="Such as 'qos.*', which stands for all that begins with qos.",
        ) from error


def get(args: Namespace) -> str | None:
    """Print the value of a parameter."""
    node = asking_node(args)
    name = check_node_name(node, args.node_name)
    request = GetParameters.Request(names=[args.parameter_name])
    values = call_node(node, GetParameters, name, 'get_parameters', request).values
    if not values or values[0].type == ParameterType.PARAMETER_NOT_SET:
        names = _names_of(node, name)
        if args.parameter_name not in names:
            raise LabError(
                f"Parameter not set: {name} has no parameter '{args.parameter_name}'.",
                todo=_other_name(args.parameter_name, names),
            )
    if not values:
        return 'Parameter not set'
    value = parameter_value_to_python(values[0])
    label = _TYPES[values[0].type][1]
    if args.hide_type:
        print(value)
    else:
        print(label) if value is None else print(label, value)
    return None


def set_parameter(args: Namespace) -> str | None:
    """Set a parameter to a value."""
    node = asking_node(args)
    name = check_node_name(node, args.node_name)
    parameter = Parameter(name=args.parameter_name, value=_value_from(args.value))
    result = _set(node, name, [parameter])[0]
    reason = f': {result.reason}' if result.reason else ''
    if result.successful:
        print(f'Set parameter successful{reason}')
        return None
    return f'Setting parameter failed{reason}'


def delete(args: Namespace) -> str | None:
    """Undeclare a parameter, where the node allows it."""
    node = asking_node(args)
    name = check_node_name(node, args.node_name)
    nothing = ParameterValue(type=ParameterType.PARAMETER_NOT_SET)
    result = _set(node, name, [Parameter(name=args.parameter_name, value=nothing)])[0]
    reason = f': {result.reason}' if result.reason else ''
    if result.successful:
        print(f'Deleted parameter successfully{reason}')
        return None
    return f'Deleting parameter failed{reason}'


def describe(args: Namespace) -> None:
    """Print what is known of parameters: type, description, what they may be."""
    node = asking_node(args)
    name = check_node_name(node, args.node_name)
    known = _names_of(node, name)
    for parameter in args.parameter_names:
        if parameter not in known:
            raise LabError(
                f"{name} has no parameter '{parameter}'.", todo=_other_name(parameter, known)
            )
    for descriptor in _descriptors(node, name, args.parameter_names):
        print('Parameter name:', descriptor.name)
        print('  Type:', _TYPES[descriptor.type][0])
        if descriptor.description:
            print('  Description:', descriptor.description)
        print('  Constraints:')
        if descriptor.read_only:
            print('    Read only: true')
        for limits in [*descriptor.floating_point_range, *descriptor.integer_range][:1]:
            print('    Min value:', limits.from_value)
            print('    Max value:', limits.to_value)
            if limits.step:
                print('    Step:', limits.step)
        if descriptor.additional_constraints:
            print('    Additional constraints:', descriptor.additional_constraints)


def dump(args: Namespace) -> None:
    """Print all parameters of a node as YAML, as `load` and `--params-file` read it."""
    node = asking_node(args)
    name = check_node_name(node, args.node_name)
    names = _names_of(node, name)
    request = GetParameters.Request(names=names)
    values = call_node(node, GetParameters, name, 'get_parameters', request).values
    tree: dict[str, Any] = {}
    for parameter, value in zip(names, values, strict=False):
        *groups, last = parameter.split('.')
        branch = tree
        for group in groups:
            branch = branch.setdefault(group, {})
        branch[last] = parameter_value_to_python(value)
    print(yaml.safe_dump({name: {'ros__parameters': tree}}, default_flow_style=False))


def load(args: Namespace) -> int:
    """Set the parameters of a node to those of a file."""
    node = asking_node(args)
    name = check_node_name(node, args.node_name)
    try:
        wanted = _parameters_in(args.parameter_file, name, wildcard=not args.no_use_wildcard)
    except OSError as error:
        raise LabError(f'{args.parameter_file} can not be read: {error.strerror}') from error
    except (yaml.YAMLError, AttributeError, TypeError, ValueError, RecursionError) as error:
        raise LabError(
            f'{args.parameter_file} is no file of parameters: {str(error).splitlines()[0]}',
            todo=f'ros2 param dump {name} shows what such a file looks like.',
        ) from error
    failed = 0
    for parameter, result in zip(wanted, _set(node, name, list(wanted.values())), strict=True):
        reason = f': {result.reason}' if result.reason else ''
        if result.successful:
            print(f'Set parameter {parameter} successful{reason}')
        else:
            failed = 1
            print(f'Set parameter {parameter} failed{reason}', file=sys.stderr)
    return failed


def _parameters_in(path: str, name: str, *, wildcard: bool) -> dict[str, Parameter]:
    """Return the parameters that a file has for a node.

    Raises:
        LabError: It has none.
        OSError: It can't be read.
        ValueError: It is not a file of parameters; other exceptions too.
    """
    nodes = yaml.safe_load(Path(path).read_text(encoding='utf-8'))
    keys = [key for key in ('/**', name) if key in nodes and (wildcard or key == name)]
    if not nodes:
        raise LabError('Param file does not contain selected parameters')
    if not keys:
        raise LabError(
            f'Param file does not contain parameters for {name}, only for nodes: {list(nodes)}'
        )
    values: dict[str, Any] = {}
    for key in keys:
        if not isinstance(nodes[key], dict) or 'ros__parameters' not in nodes[key]:
            raise LabError(f'YAML file is not a valid ROS parameter file for node {key}')
        values.update(_flat(nodes[key]['ros__parameters']))
    make: Any = NodeParameter
    return {key: make(key, value=value).to_parameter_msg() for key, value in values.items()}


def _flat(tree: dict[str, Any], start: str = '') -> Iterator[tuple[str, Any]]:
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from _flat(value, f'{start}{key}.')
        else:
            yield f'{start}{key}', value


def _names_of(node: Node, name: str, prefixes: Iterable[str] = ()) -> list[str]:
    request = ListParameters.Request(prefixes=list(prefixes))
    response = call_node(node, ListParameters, name, 'list_parameters', request)
    return sorted(response.result.names)


def _descriptors(node: Node, name: str, names: list[str]) -> Any:
    request = DescribeParameters.Request(names=names)
    return call_node(node, DescribeParameters, name, 'describe_parameters', request).descriptors


def _types_of(node: Node, name: str, names: list[str]) -> dict[str, str]:
    found = _descriptors(node, name, names)
    return {descriptor.name: _TYPES[descriptor.type][0] for descriptor in found}


def _set(node: Node, name: str, parameters: list[Parameter]) -> list[SetParametersResult]:
    request = SetParameters.Request(parameters=parameters)
    return list(call_node(node, SetParameters, name, 'set_parameters', request).results)


def _value_from(text: str) -> ParameterValue:
    """Return a value of the type that a text looks like; a text that is not YAML is a string."""
    try:
        return get_parameter_value(text)
    except (yaml.YAMLError, AssertionError, ValueError, RecursionError):
        return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=text)


def _other_name(name: str, names: list[str]) -> str:
    hint = unknown(name, names, 'param')
    return hint if hint.startswith('Did') else f'It has: {", ".join(names)}.'


def _parameters(args: Namespace) -> Iterable[str]:
    """Return the parameters to offer for completion."""
    node = asking_node(args)
    return _names_of(node, check_node_name(node, args.node_name, timeout_sec=0.0))


def _node_arguments(parser: Parser, *, optional: bool = False) -> None:
    add_discovery_options(parser)
    parser.add(
        'node_name',
        help='Name of the ROS node',
        complete=node_names,
        **({'nargs': '?'} if optional else {}),
    )
    parser.add('--include-hidden-nodes', action='store_true', help='Consider hidden nodes as well')
    parser.add(
        '--timeout', metavar='N', type=positive_float, help='accepted; 1 s is waited for a node'
    )


def _list_arguments(parser: Parser) -> None:
    _node_arguments(parser, optional=True)
    parser.add(
        '--filter',
        metavar='REGEX',
        default='',
        help='Only list parameters whose names match a regular expression, from their beginning',
    )
    parser.add(
        '--param-prefixes',
        nargs='+',
        default=[],
        help='Only list parameters with the provided prefixes',
    )
    parser.add(
        '--param-type', action='store_true', help='Print parameter types with parameter names'
    )


def _parameter_arguments(parser: Parser) -> None:
    _node_arguments(parser)
    parser.add('parameter_name', help='Name of the parameter', complete=_parameters)


def _get_arguments(parser: Parser) -> None:
    _parameter_arguments(parser)
    parser.add('--hide-type', action='store_true', help='Hide the type information')


def _set_arguments(parser: Parser) -> None:
    _parameter_arguments(parser)
    parser.add('value', help='Value of the parameter')


def _describe_arguments(parser: Parser) -> None:
    _node_arguments(parser)
    parser.add('parameter_names', nargs='+', help='Names of the parameters', complete=_parameters)


def _load_arguments(parser: Parser) -> None:
    _node_arguments(parser)
    parser.add('parameter_file', help='Parameter file')
    parser.add(
        '--no-use-wildcard',
        action='store_true',
        help="Do not load parameters in the '/**' namespace into the node",
    )


COMMAND = Command(
    'param',
    'Various param related sub-commands',
    (
        Verb(
            'delete',
            'Delete parameter',
            delete,
            _parameter_arguments,
            'A parameter that is not deleted gives exit code 1 here, and one that is 0; the real '
            'one has it the other way round.',
        ),
        Verb(
            'describe',
            'Show descriptive information about declared parameters',
            describe,
            _describe_arguments,
            'A parameter that the node does not have is an error here, with exit code 1; the real '
            'one says nothing.',
        ),
        Verb(
            'dump',
            'Show all of the parameters of a node in a YAML file format',
            dump,
            _node_arguments,
        ),
        Verb('get', 'Get parameter', get, _get_arguments),
        Verb('list', 'Output a list of available parameters', list_parameters, _list_arguments),
        Verb(
            'load',
            'Load parameter file for a node',
            load,
            _load_arguments,
            'A parameter that is not set, or a file for another node, gives exit code 1 here; the '
            'real one sets all that the file has, for whatever node, and ends with 0.',
        ),
        Verb(
            'set',
            'Set parameter',
            set_parameter,
            _set_arguments,
            'A parameter that is not set gives exit code 1 here; the real one ends with 0.',
        ),
    ),
)
