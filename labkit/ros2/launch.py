"""`ros2 launch`: start what a launch file describes.

In a terminal it runs in the foreground, as with the real command. In a notebook it runs in the
background, and a second run of the cell ends the first.
"""

from __future__ import annotations

import os
import sys
from argparse import Namespace
from collections.abc import Iterable
from pathlib import Path

from labkit import settings
from labkit.errors import LabError
from labkit.launching.actions import IncludeLaunchDescription, Source
from labkit.launching.launch_files import arguments, find, launch_files, load, tree
from labkit.launching.launch_service import Service
from labkit.programs.child_environment import environment, teller
from labkit.ros2.parser import Command, Parser, Verb
from labkit.rosgraph.packages import package_names

__all__ = ['COMMAND']


def launch(args: Namespace) -> int | None:
    """Launch a file, or tell about it."""
    path, given = _chosen(args)
    if args.print_description:
        print(f'LaunchDescription of {path}', *tree(load(path).entities), sep='\n')
        return None
    if args.show_args:
        _show_arguments(path)
        return None
    pairs = dict(_pair(word) for word in given)
    if settings.in_kernel():
        from labkit.launching.launched import start

        print(start(path, pairs, name=_name(args)).summary)
        return None
    os.environ.update(environment())
    if args.all_output:
        os.environ['OVERRIDE_LAUNCH_PROCESS_OUTPUT'] = 'both'
    root = IncludeLaunchDescription(Source(path), launch_arguments=pairs.items())
    interactive = sys.stdin.isatty() and not args.noninteractive
    tell = teller()
    try:
        service = Service([root], interactive=interactive, debug=args.debug, argv=given, tell=tell)
        return service.run()
    except LabError as error:
        if tell is not None:
            tell({'fault': error.message, 'todo': error.todo})
        raise


def _chosen(args: Namespace) -> tuple[str, list[str]]:
    """Return the path of the file, and the arguments that follow it.

    Raises:
        LabError: There is no such file.
    """
    first, second, rest = args.package_name, args.launch_file_name, args.launch_arguments
    if os.path.isfile(first):
        return os.path.abspath(first), [*filter(None, [second]), *rest]
    if second is None or ':=' in second:
        if '/' in first or '.' in first:
            load(first)  # tells what is near
        raise LabError(
            f'There is no launch file {first!r} here.',
            todo='ros2 launch takes the path of a file, or a package and the name of its file.',
        )
    return find(first, second), rest


def _pair(word: str) -> tuple[str, str]:
    name, sign, value = word.partition(':=')
    if not (name and sign and value):
        raise LabError(f"malformed launch argument '{word}', expected format '<name>:=<value>'")
    return name, value


def _name(args: Namespace) -> str:
    words = [args.package_name, args.launch_file_name, *args.launch_arguments]
    return ' '.join(['ros2 launch', *filter(None, words)])


def _show_arguments(path: str) -> None:
    print("Arguments (pass arguments as '<name>:=<value>'):")
    found = list(arguments([load(path)]))
    for argument, conditional in found:
        print(f"\n    '{argument.name}':{'*' * conditional}\n        {argument.description}")
        if argument.default_value is not None:
            text = ' + '.join(part.describe() for part in argument.default_value)
            print(f'        (default: {text})')
    if not found:
        print('\n  No arguments.')
    elif any(conditional for _, conditional in found):
        print('\n* argument(s) which are only used if specific conditions occur')


def _first(_: Namespace) -> Iterable[str]:
    here = [str(path) for path in Path().glob('*launch*') if path.is_file()]
    return [*here, *package_names()]


def _second(args: Namespace) -> Iterable[str]:
    return [path.name for path in launch_files(args.package_name) if 'launch' in path.name]


def _arguments(parser: Parser) -> None:
    parser.flag(
        '-n, --noninteractive',
        'Run the launch system non-interactively, with no terminal associated',
    )
    parser.flag(
        '-d, --debug', 'Put the launch system in debug mode, provides more verbose output.'
    )
    parser.flag(
        '-p, --print, --print-description',
        'Print the launch description to the console without launching it.',
        dest='print_description',
    )
    parser.flag(
        '-s, --show-args, --show-arguments',
        'Show arguments that may be given to the launch file.',
        dest='show_args',
    )
    parser.flag(
        '-a, --show-all-subprocesses-output',
        "Show all launched subprocesses' output by overriding their output configuration "
        'using the OVERRIDE_LAUNCH_PROCESS_OUTPUT envvar.',
        dest='all_output',
    )
    parser.add(
        'package_name',
        help='Name of the ROS package which contains the launch file',
        complete=_first,
    )
    parser.add('launch_file_name', nargs='?', help='Name of the launch file', complete=_second)
    parser.add(
        'launch_arguments',
        nargs='*',
        help="Arguments to the launch file; '<name>:=<value>' (for duplicates, last one wins)",
    )


COMMAND = Command(
    'launch', 'Run a launch file', (Verb('launch', 'Run a launch file', launch, _arguments),)
)
