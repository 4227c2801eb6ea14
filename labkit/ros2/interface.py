"""`ros2 interface`: list and show interface types."""

from __future__ import annotations

import sys
from argparse import Namespace

from ament_index_python import get_packages_with_prefixes

from labkit import settings
from labkit.ros2.parser import Command, Parser, Usage, Verb, real_one
from labkit.rosgraph import interfaces
from labkit.rosgraph.definitions import definition
from labkit.rosgraph.message_yaml import to_yaml

__all__ = ['COMMAND']

_TITLES = {'msg': 'Messages:', 'srv': 'Services:', 'action': 'Actions:'}
_ONLY = {'msg': 'msgs', 'srv': 'srvs', 'action': 'actions'}
_WORDS = {'msg': 'message', 'srv': 'service', 'action': 'action'}


def list_interfaces(args: Namespace) -> None:
    """Print the names of all interface types."""
    for kind in _kinds(args):
        print(_TITLES[kind])
        for name in interfaces.names(kind):
            print(f'    {name}')


def list_package(args: Namespace) -> None:
    """Print the names of the interface types of one package."""
    with real_one():
        interfaces.check_package(args.package_name)
    kinds = _kinds(args)
    for name in interfaces.listed_in(args.package_name):
        if name.split('/')[1] in kinds:
            print(name)


def list_packages(args: Namespace) -> None:
    """Print the names of the packages with interface types."""
    kinds = _kinds(args)
    found = {package for kind in kinds for package in interfaces.packages(kind)}
    print('\n'.join(sorted(found)))


def show(args: Namespace) -> None:
    """Print the definition of an interface type, including nested types."""
    asked = _type(args)
    with real_one(says=_in_real_words(asked)):
        name = interfaces.check_exists(asked)
    if args.all_comments and args.no_comments:
        raise Usage('ros2 interface show: --all-comments and --no-comments can not go together.')
    for line in definition(name, comments=not args.no_comments, nested_comments=args.all_comments):
        print(line)


def _in_real_words(name: str) -> str:
    """Return what the real `show` says of a type that is not there."""
    package, *rest = name.split('/')
    if len(rest) != 2:
        return f"Invalid name '{name}'. Expected three parts separated by '/'"
    prefix = get_packages_with_prefixes().get(package)
    if not prefix:
        return f"Unknown package '{package}'"
    return f"Could not find the interface '{prefix}/share/{name}.idl'"


def show_prototype(args: Namespace) -> None:
    """Print the default values of a message as YAML, to be edited and published."""
    name = interfaces.check_exists(args.type)
    if name.split('/')[1] == 'srv':
        text = to_yaml(interfaces.service_class(name).Request())
    elif name in interfaces.names('action'):
        text = to_yaml(interfaces.action_class(name).Goal())
    else:
        text = to_yaml(interfaces.message_class(name)())
    print(text if args.no_quotes else f'"{text}"')


def _type(args: Namespace) -> str:
    """Return the requested type; `-` means a line of standard input."""
    if args.type != '-':
        return str(args.type)
    if settings.in_kernel() or sys.stdin.isatty():
        raise Usage('ros2 interface show: - reads the name from a pipe, and there is none.')
    return sys.stdin.readline().strip()


def _kinds(args: Namespace) -> list[str]:
    chosen = [kind for kind, word in _ONLY.items() if getattr(args, f'only_{word}')]
    return chosen or list(_ONLY)


def _kind_options(parser: Parser) -> None:
    for kind, word in _ONLY.items():
        text = f'Print out only the {_WORDS[kind]} types'
        parser.flag(f'-{word[0]}, --only-{word}', text)


def _package_arguments(parser: Parser) -> None:
    _kind_options(parser)
    parser.add(
        'package_name',
        help="Name of the ROS package (e.g. 'std_msgs')",
        complete=lambda _: interfaces.packages(),
    )


def _show_arguments(parser: Parser) -> None:
    parser.add(
        'type',
        help="Show an interface definition (e.g. 'std_msgs/msg/String'). Passing '-' reads the "
        "argument from stdin (e.g. 'ros2 topic type /chatter | ros2 interface show -').",
        complete=lambda _: interfaces.names(),
    )
    parser.flag('--all-comments', 'Show all comments, including for nested interface definitions')
    parser.flag('--no-comments', 'Show no comments or whitespace')


def _proto_arguments(parser: Parser) -> None:
    parser.add(
        'type',
        help='Show an interface definition (e.g. "std_msgs/msg/String")',
        complete=lambda _: interfaces.names(),
    )
    parser.flag('--no-quotes', 'if true output has no outer quotes.')


COMMAND = Command(
    'interface',
    'Show information about ROS interfaces',
    (
        Verb('list', 'List all interface types available', list_interfaces, _kind_options),
        Verb(
            'package',
            'Output a list of available interface types within one package',
            list_package,
            _package_arguments,
        ),
        Verb(
            'packages',
            'Output a list of packages that provide interfaces',
            list_packages,
            _kind_options,
        ),
        Verb('proto', 'Output an interface prototype', show_prototype, _proto_arguments),
        Verb('show', 'Output the interface definition', show, _show_arguments),
    ),
)
