"""The parameters of a node, read and set by calls of the services that a node has for them."""

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

from labkit.background.service_calls import call_node
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
    """Tell whether a node can be asked for its parameters.

    Args:
        node: The node to ask the graph with.
        node_name: Full name of the node that is asked about.
    """
    return f'{node_name}/list_parameters' in dict(services(node, include_hidden=True))


def parameter_names(node: Node, node_name: str, prefixes: Iterable[str] = ()) -> list[str]:
    """Return the names of a node's parameters, sorted.

    Args:
        node: The node that asks.
        node_name: Full name of the node that is asked.
        prefixes: Groups of parameters; all of them if there is none.

    Raises:
        LabError: The node has no parameter services, or does not answer.
    """
    request = ListParameters.Request(prefixes=list(prefixes))
    response = call_node(node, ListParameters, node_name, 'list_parameters', request)
    return sorted(response.result.names)


def get_parameters(node: Node, node_name: str, names: list[str]) -> list[ParameterValue]:
    """Return the values of parameters, in their order; none at all if one is missing.

    Args:
        node: The node that asks.
        node_name: Full name of the node that is asked.
        names: Names of the parameters.

    Raises:
        LabError: The node has no parameter services, or does not answer.
    """
    request = GetParameters.Request(names=names)
    return list(call_node(node, GetParameters, node_name, 'get_parameters', request).values)


def describe_parameters(node: Node, node_name: str, names: list[str]) -> list[ParameterDescriptor]:
    """Return what is known of parameters besides their values.

    Args:
        node: The node that asks.
        node_name: Full name of the node that is asked.
        names: Names of the parameters.

    Raises:
        LabError: The node has no parameter services, or does not answer.
    """
    request = DescribeParameters.Request(names=names)
    response = call_node(node, DescribeParameters, node_name, 'describe_parameters', request)
    return list(response.descriptors)


def set_parameters(
    node: Node, node_name: str, parameters: list[Parameter]
) -> list[SetParametersResult]:
    """Set parameters, and return for each whether that went well, and why not.

    Args:
        node: The node that asks.
        node_name: Full name of the node that is asked.
        parameters: Names and values.

    Raises:
        LabError: The node has no parameter services, or does not answer.
    """
    request = SetParameters.Request(parameters=parameters)
    return list(call_node(node, SetParameters, node_name, 'set_parameters', request).results)


def set_parameters_atomically(
    node: Node, node_name: str, parameters: list[Parameter]
) -> SetParametersResult:
    """Set all of some parameters at once, or none of them; return whether that went well.

    Args:
        node: The node that asks.
        node_name: Full name of the node that is asked.
        parameters: Names and values.

    Raises:
        LabError: The node has no parameter services, or does not answer.
    """
    request = SetParametersAtomically.Request(parameters=parameters)
    service = 'set_parameters_atomically'
    return call_node(node, SetParametersAtomically, node_name, service, request).result


def delete_parameter(node: Node, node_name: str, name: str) -> SetParametersResult:
    """Undeclare a parameter, and return whether that went well, and why not.

    Args:
        node: The node that asks.
        node_name: Full name of the node that is asked.
        name: Name of the parameter.

    Raises:
        LabError: The node has no parameter services, or does not answer.
    """
    return set_parameters(node, node_name, [Parameter(name=name, value=ParameterValue())])[0]
