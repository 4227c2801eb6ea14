"""Read and set parameters of a node by calling its parameter services.

Each function asks with `node`, and raises a LabError if the node of the full name `node_name` has
no parameter services, or does not answer.
"""

from __future__ import annotations

from collections.abc import Iterable

from rcl_interfaces.msg import (
    Parameter,
    ParameterDescriptor,
    ParameterValue,
    SetParametersResult,
)
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.node import Node

from labkit.asking.service_calls import call_node
from labkit.rosgraph.listings import services

__all__ = [
    'delete_parameter',
    'describe_parameters',
    'get_parameters',
    'has_parameters',
    'parameter_names',
    'set_parameters',
    'set_parameters_atomically',
]


def has_parameters(node: Node, node_name: str) -> bool:
    """Return whether a node has parameter services."""
    return f'{node_name}/list_parameters' in dict(services(node, include_hidden=True))


def parameter_names(node: Node, node_name: str, prefixes: Iterable[str] = ()) -> list[str]:
    """Return the names of a node's parameters, or only those with some prefixes, sorted."""
    request = ListParameters.Request(prefixes=list(prefixes))
    response = call_node(node, ListParameters, node_name, 'list_parameters', request)
    return sorted(response.result.names)


def get_parameters(node: Node, node_name: str, names: list[str]) -> dict[str, ParameterValue]:
    """Return the values of those parameters that the node has and that have one, in this order."""
    request = GetParameters.Request(names=names)
    values = call_node(node, GetParameters, node_name, 'get_parameters', request).values
    if len(values) == len(names):
        return dict(zip(names, values, strict=True))
    # A node answers with nothing at all if one of them is missing, or declared without a value.
    found: dict[str, ParameterValue] = {}
    for name in names if len(names) > 1 else ():
        found |= get_parameters(node, node_name, [name])
    return found


def describe_parameters(node: Node, node_name: str, names: list[str]) -> list[ParameterDescriptor]:
    """Return the descriptors of parameters."""
    request = DescribeParameters.Request(names=names)
    response = call_node(node, DescribeParameters, node_name, 'describe_parameters', request)
    return list(response.descriptors)


def set_parameters(
    node: Node, node_name: str, parameters: list[Parameter]
) -> list[SetParametersResult]:
    """Set parameters one by one, and return a result for each."""
    request = SetParameters.Request(parameters=parameters)
    return list(call_node(node, SetParameters, node_name, 'set_parameters', request).results)


def set_parameters_atomically(
    node: Node, node_name: str, parameters: list[Parameter]
) -> SetParametersResult:
    """Set either all of the parameters or none, and return the result."""
    request = SetParametersAtomically.Request(parameters=parameters)
    service = 'set_parameters_atomically'
    return call_node(node, SetParametersAtomically, node_name, service, request).result


def delete_parameter(node: Node, node_name: str, name: str) -> SetParametersResult:
    """Undeclare a parameter, and return the result."""
    return set_parameters(node, node_name, [Parameter(name=name, value=ParameterValue())])[0]
