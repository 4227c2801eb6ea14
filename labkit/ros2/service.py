"""`ros2 service`: list services, and call one."""

from __future__ import annotations

import argparse
import sys
import time
from argparse import Namespace
from collections.abc import Iterable
from typing import TYPE_CHECKING

from labkit import settings
from labkit.asking.discovery import poll_until
from labkit.asking.service_calls import ServiceCalls
from labkit.background.runtime import runtime
from labkit.errors import LabError
from labkit.ros2.graph_completion import service_names, types_of_service
from labkit.ros2.graph_queries import (
    add_discovery_options,
    asking_node,
    full_name,
    known_names,
    print_names,
    print_names_of,
    unknown,
    values_text,
)
from labkit.ros2.parser import Command, Parser, Verb, positive_float, real_one
from labkit.ros2.service_echo import ECHO
from labkit.rosgraph import interfaces
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.listings import service_types, services
from labkit.rosgraph.message_yaml import fill, prototype, read_yaml
from labkit.rosgraph.refusals import Refusal, Refused

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['COMMAND']

HIDDEN = '--include-hidden-services'
WAITING = 'waiting for service to become available...'


def list_services(args: Namespace) -> None:
    """Print the names of the services."""
    found = known_names(args, 'services', include_hidden=args.include_hidden_services)
    print_names(args, found, args.count_services)


def show_type(args: Namespace) -> None:
    """Print a service's type."""
    node = asking_node(args)
    with real_one(says=''):
        types = _types_of(node, args.service_name)
    print('\n'.join(types))


def show_info(args: Namespace) -> None:
    """Print a service's type, and the number of its clients and servers."""
    node = asking_node(args)
    with real_one():
        types = _types_of(node, args.service_name)
    print(f'Type: {types[0] if len(types) == 1 else types}')
    print(f'Clients count: {node.count_clients(args.service_name)}')
    print(f'Services count: {node.count_services(args.service_name)}')


def find(args: Namespace) -> None:
    """Print the services of a type."""
    found = known_names(args, 'services', include_hidden=args.include_hidden_services)
    print_names_of(args.service_type, 'srv', found, args.count_services)


def call(args: Namespace) -> None:
    """Call a service, and print request and response."""
    srv_type = interfaces.service_class(args.service_type)
    request = srv_type.Request()
    fill(request, read_yaml(values_text(args, 'service call', args.values)))
    # A new process knows no services yet; the real command is always one when it makes its client.
    waiting = not runtime.started
    if waiting:
        print(WAITING, flush=True)
    node = asking_node(args)
    name = full_name(args.service_name, node)
    _check_type(node, name, type_name(srv_type))
    limit = settings.audience().patience_sec
    with ServiceCalls(node, srv_type, name) as service:
        if not waiting and not service.wait_until_ready(0.0):
            print(WAITING, flush=True)
        if not service.wait_until_ready(limit):
            raise LabError(f'{name} has not become available.')
        while True:
            print(f'requester: making request: {request!r}\n', flush=True)
            started = time.monotonic()
            print(f'response:\n{service.call(request, limit)!r}\n', flush=True)
            if args.rate is None:
                return
            time.sleep(max(0.0, started + 1 / args.rate - time.monotonic()))


def _check_type(node: Node, name: str, wanted: str) -> None:
    """Raise a LabError if a service exists with another type: the call would never return."""
    types = poll_until(lambda: service_types(node, name), 0.3)
    if types and wanted not in types:
        raise Refused(
            f'{name} is of type {", ".join(types)}, not {wanted}.', reason=Refusal.OTHER_TYPE
        )
    if not node.count_services(name):
        names = [other for other, _ in services(node) if node.count_services(other)]
        hint = unknown(name, names, 'service')
        if types:
            print(f'{name} has clients, but no node offers it.', file=sys.stderr, flush=True)
        if hint.startswith('Did you mean'):
            print(hint, file=sys.stderr, flush=True)


def _types_of(node: Node, name: str) -> list[str]:
    types = poll_until(lambda: service_types(node, name))
    if not types:
        names = [other for other, _ in services(node)]
        raise LabError(f"Unknown service '{name}'", todo=unknown(name, names, 'service'))
    return types


def _prototype(args: Namespace) -> Iterable[str]:
    srv_type = interfaces.service_class(getattr(args, 'service_type', '') or '')
    return [f'"{prototype(srv_type.Request)}"']


def _hidden_option(parser: Parser, *, shown: bool) -> None:
    text = 'Consider hidden services as well' if shown else argparse.SUPPRESS
    parser.flag(HIDDEN, text)


def _count_option(parser: Parser) -> None:
    parser.flag('-c, --count-services', 'Only display the number of services discovered')


def _name_argument(parser: Parser, text: str) -> None:
    add_discovery_options(parser)
    parser.add('service_name', help=text, complete=service_names)
    _hidden_option(parser, shown=False)


def _list_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.flag('-t, --show-types', 'Additionally show the service type')
    _count_option(parser)
    _hidden_option(parser, shown=True)


def _type_arguments(parser: Parser) -> None:
    _name_argument(parser, "Name of the ROS service to get type (e.g. '/talker/list_parameters')")


def _info_arguments(parser: Parser) -> None:
    _name_argument(parser, "Name of the ROS service to get info (e.g. '/add_two_ints')")


def _find_arguments(parser: Parser) -> None:
    add_discovery_options(parser)
    parser.add(
        'service_type',
        help="Name of the ROS service type to filter for (e.g. 'rcl_interfaces/srv/"
        "ListParameters')",
        complete=lambda _: interfaces.names('srv'),
    )
    _count_option(parser)
    _hidden_option(parser, shown=True)


def _call_arguments(parser: Parser) -> None:
    _name_argument(parser, "Name of the ROS service to call to (e.g. '/add_two_ints')")
    parser.add(
        'service_type',
        help="Type of the ROS service (e.g. 'std_srvs/srv/Empty')",
        complete=types_of_service,
    )
    parser.add(
        'values',
        nargs='?',
        default='{}',
        help="Values to fill the service request with in YAML format (e.g. '{a: 1, b: 2}'), "
        'otherwise the service request will be published with default values',
        complete=_prototype,
    )
    parser.flag('--stdin', 'Read values from standard input')
    parser.add(
        *('-r', '--rate'),
        metavar='N',
        type=positive_float,
        help='Repeat the call at a specific rate in Hz',
    )


COMMAND = Command(
    'service',
    'Various service related sub-commands',
    (
        Verb(
            'call',
            'Call a service',
            call,
            _call_arguments,
            'Values that a field can not hold are refused here, with exit code 1; the real one '
            'converts some of them.',
        ),
        ECHO,
        Verb(
            'find',
            'Output a list of available services of a given type',
            find,
            _find_arguments,
            'A type that is not installed is an error here, with exit code 1; the real one finds '
            'nothing, as this one does into a pipe.',
        ),
        Verb('info', 'Print information about a service', show_info, _info_arguments),
        Verb('list', 'Output a list of available services', list_services, _list_arguments),
        Verb('type', "Output a service's type", show_type, _type_arguments),
    ),
    {HIDDEN: 'Consider hidden services as well'},
)
