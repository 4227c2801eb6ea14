"""`ros2 param`: the parameters of nodes."""

from __future__ import annotations

import re
import sys
from argparse import Namespace
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from rcl_interfaces.msg import Parameter, ParameterValue

from labkit.asking.parameter_calls import (
    delete_parameter,
    describe_parameters,
    get_parameters,
    has_parameters,
    parameter_names,
    set_parameters,
)
from labkit.errors import LabError, quoted
from labkit.ros2.graph_completion import node_names
from labkit.ros2.graph_queries import add_discovery_options, asking_node, check_node_name, unknown
from labkit.ros2.parser import Command, Parser, Usage, Verb, positive_float, real_one
from labkit.rosgraph.names import is_hidden
from labkit.rosgraph.parameter_values import (
    NOT_SET,
    parameters_in,
    python_value,
    to_yaml,
    type_word,
    value_from,
)
from labkit.rosgraph.snapshot import node_names as names_of_nodes

if TYPE_CHECKING:
    from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
    from rclpy.node import Node

__all__ = ['COMMAND']


def list_parameters(args: Namespace) -> None:
    """Print the names of the parameters of one node or of all."""
    wanted = _pattern(args.filter)
    node = asking_node(args)
    if args.node_name:
        chosen = [check_node_name(node, args.node_name)]
    else:
        chosen = [
            name
            for name in dict.fromkeys(names_of_nodes(node))
            if args.include_hidden_nodes or not is_hidden(name)
            if has_parameters(node, name)
        ]
    for name in chosen:
        try:
            names = list(filter(wanted.match, parameter_names(node, name, args.param_prefixes)))
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
            f'ros2 param list: {quoted(text)} is no regular expression: {error}.',
            todo="Such as 'qos.*', which stands for all that begins with qos.",
        ) from error


def get(args: Namespace) -> str | None:
    """Print the value of a parameter."""
    node = asking_node(args)
    name = check_node_name(node, args.node_name)
    values = get_parameters(node, name, [args.parameter_name])
    found = values.get(args.parameter_name)
    kind = type_word(found.type) if found else NOT_SET
    if kind == NOT_SET:
        names = parameter_names(node, name)
        if args.parameter_name not in names:
            with real_one(says='Parameter not set'):
                raise LabError(
                    f"Parameter not set: {name} has no parameter '{args.parameter_name}'.",
                    todo=_other_name(args.parameter_name, names),
                )
    if found is None:
        return 'Parameter not set'
    value = python_value(found)
    if args.hide_type:
        print(value)
    else:
        print(_label(kind)) if value is None else print(_label(kind), value)
    return None


def set_parameter(args: Namespace) -> None:
    """Set a parameter to a value."""
    node = asking_node(args)
    name = check_node_name(node, args.node_name)
    parameter = Parameter(name=args.parameter_name, value=value_from(args.value))
    result = set_parameters(node, name, [parameter])[0]
    _check(_told(result, 'Set parameter successful', 'Setting parameter failed'))


def delete(args: Namespace) -> None:
    """Undeclare a parameter, if the node allows it."""
    node = asking_node(args)
    name = check_node_name(node, args.node_name)
    result = delete_parameter(node, name, args.parameter_name)
    _check(_told(result, 'Deleted parameter successfully', 'Deleting parameter failed'))


def describe(args: Namespace) -> None:
    """Print the descriptors of parameters: type, description, constraints."""
    node = asking_node(args)
    name = check_node_name(node, args.node_name)
    known = parameter_names(node, name)
    there = [parameter for parameter in args.parameter_names if parameter in known]
    found = describe_parameters(node, name, there) if there else []
    text = '\n'.join(line for descriptor in found for line in _described(descriptor))
    for parameter in args.parameter_names:
        if parameter not in known:
            with real_one(says='', shows=text, code=0):
                raise LabError(
                    f"{name} has no parameter '{parameter}'.", todo=_other_name(parameter, known)
                )
    print(text)


def _described(descriptor: ParameterDescriptor) -> Iterator[str]:
    yield f'Parameter name: {descriptor.name}'
    yield f'  Type: {type_word(descriptor.type)}'
    if descriptor.description:
        yield f'  Description: {descriptor.description}'
    yield '  Constraints:'
    if descriptor.read_only:
        yield '    Read only: true'
    for limits in [*descriptor.floating_point_range, *descriptor.integer_range][:1]:
        yield f'    Min value: {limits.from_value}'
        yield f'    Max value: {limits.to_value}'
        if limits.step:
            yield f'    Step: {limits.step}'
    if descriptor.additional_constraints:
        yield f'    Additional constraints: {descriptor.additional_constraints}'


def dump(args: Namespace) -> None:
    """Print all parameters of a node as YAML that `load` and `--params-file` can read."""
    node = asking_node(args)
    name = check_node_name(node, args.node_name)
    names = parameter_names(node, name)
    values = get_parameters(node, name, names)
    bare = [each for each in names if python_value(values.get(each, ParameterValue())) is None]
    print(to_yaml(name, {each: values[each] for each in names if each not in bare}))
    if bare:
        print(f'Left out, as without a value: {", ".join(bare)}', file=sys.stderr)


def load(args: Namespace) -> None:
    """Set the parameters of a node from a file."""
    node = asking_node(args)
    name = check_node_name(node, args.node_name)
    wanted = parameters_in(args.parameter_file, name, wildcard=not args.no_use_wildcard)
    results = set_parameters(node, name, list(wanted.values()))
    words = 'Set parameter {} successful', 'Set parameter {} failed'
    complaints = [
        _told(result, *(text.format(parameter) for text in words))
        for parameter, result in zip(wanted, results, strict=True)
    ]
    _check('\n'.join(filter(None, complaints)))


def _told(result: SetParametersResult, good: str, bad: str) -> str:
    """Print that a parameter was set; return an error message if it was not."""
    reason = f': {result.reason}' if result.reason else ''
    if not result.successful:
        return f'{bad}{reason}'
    print(f'{good}{reason}')
    return ''


def _check(complaint: str) -> None:
    """Raise a LabError if there is a complaint. With the real one the exit code stays 0."""
    if complaint:
        with real_one(code=0):
            raise LabError(complaint)


def _label(kind: str) -> str:
    """Return the text with which `get` introduces a value."""
    if kind == NOT_SET:
        return 'Parameter not set.'
    word = kind.removesuffix(' array').capitalize()
    return f'{word} values are:' if kind.endswith('array') else f'{word} value is:'


def _types_of(node: Node, name: str, names: list[str]) -> dict[str, str]:
    found = describe_parameters(node, name, names)
    return {descriptor.name: type_word(descriptor.type) for descriptor in found}


def _other_name(name: str, names: list[str]) -> str:
    hint = unknown(name, names, 'param')
    return hint if hint.startswith('Did') else f'It has: {", ".join(names)}.'


def _parameters(args: Namespace) -> Iterable[str]:
    """Return completion candidates for a parameter name."""
    node = asking_node(args)
    return parameter_names(node, check_node_name(node, args.node_name, timeout_sec=0.0))


def _node_arguments(parser: Parser, *, optional: bool = False) -> None:
    add_discovery_options(parser)
    parser.add(
        'node_name',
        help='Name of the ROS node',
        complete=node_names,
        **({'nargs': '?'} if optional else {}),
    )
    parser.flag('--include-hidden-nodes', 'Consider hidden nodes as well')
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
    parser.flag('--param-type', 'Print parameter types with parameter names')


def _parameter_arguments(parser: Parser) -> None:
    _node_arguments(parser)
    parser.add('parameter_name', help='Name of the parameter', complete=_parameters)


def _get_arguments(parser: Parser) -> None:
    _parameter_arguments(parser)
    parser.flag('--hide-type', 'Hide the type information')


def _set_arguments(parser: Parser) -> None:
    _parameter_arguments(parser)
    parser.add('value', help='Value of the parameter')


def _describe_arguments(parser: Parser) -> None:
    _node_arguments(parser)
    parser.add('parameter_names', nargs='+', help='Names of the parameters', complete=_parameters)


def _load_arguments(parser: Parser) -> None:
    _node_arguments(parser)
    parser.add('parameter_file', help='Parameter file')
    parser.flag('--no-use-wildcard', "Do not load parameters in the '/**' namespace into the node")


COMMAND = Command(
    'param',
    'Various param related sub-commands',
    (
        Verb(
            'delete',
            'Delete parameter',
            delete,
            _parameter_arguments,
            'A parameter that is not deleted gives exit code 1 here; the real one ends with 0, as '
            'this one does into a pipe.',
        ),
        Verb(
            'describe',
            'Show descriptive information about declared parameters',
            describe,
            _describe_arguments,
            'A parameter that the node does not have is an error here, with exit code 1; the real '
            'one says nothing, as this one does into a pipe.',
        ),
        Verb(
            'dump',
            'Show all of the parameters of a node in a YAML file format',
            dump,
            _node_arguments,
            'A parameter declared without a value is left out here, and named; the real one then '
            'leaves out all of them, without a word.',
        ),
        Verb('get', 'Get parameter', get, _get_arguments),
        Verb('list', 'Output a list of available parameters', list_parameters, _list_arguments),
        Verb(
            'load',
            'Load parameter file for a node',
            load,
            _load_arguments,
            'A parameter that is not set gives exit code 1 here; the real one ends with 0, as '
            'this one does into a pipe. A file for another node is refused here; the real one '
            'sets all that the file has, for whatever node.',
        ),
        Verb(
            'set',
            'Set parameter',
            set_parameter,
            _set_arguments,
            'A parameter that is not set gives exit code 1 here; the real one ends with 0, as '
            'this one does into a pipe.',
        ),
    ),
)
