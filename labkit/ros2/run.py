"""`ros2 run`: start an executable of a package in its own process.

In a terminal it runs in the foreground, as with the real command. In a notebook it runs in the
background, so that the next cell can watch it.
"""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from argparse import Namespace

from labkit import settings
from labkit.asking.discovery import is_only_process
from labkit.programs.child_processes import end_earlier, environment, start_process
from labkit.ros2.graph_queries import asking_node
from labkit.ros2.parser import Command, Parser, Verb
from labkit.rosgraph.packages import Executable, executable, executables, with_executables
from labkit.rosgraph.snapshot import node_names

__all__ = ['COMMAND']

# Time for the node of a process to appear. On a busy machine Python itself takes a while.
APPEAR_SEC = 15.0


def run(args: Namespace) -> int | None:
    """Start an executable."""
    chosen = executable(args.package_name, args.executable_name)
    command = [*shlex.split(args.prefix or ''), *chosen.command, *args.argv]
    if not settings.in_kernel():
        if chosen.stand_in:
            print(_stand_in_note(chosen), file=sys.stderr, flush=True)
        sys.stdout.flush()
        os.execvpe(command[0], command, environment())
    node = asking_node(args)
    name = f'{args.package_name} {args.executable_name}'
    end_earlier(command)
    before = node_names(node)
    process = start_process(name, command, environment(), announces=chosen.own)
    process.wait_for_nodes(node, before, 0.0 if is_only_process() else APPEAR_SEC)
    if not process.running and process.exit_code:
        print('\n'.join(process.output[-10:]))
        print(f'{name} ended with exit code {process.exit_code}.')
        return process.exit_code
    as_node = f', as node {" and ".join(process.nodes)}' if process.nodes else ''
    print(f'{name} runs in a process of its own{as_node}. lab.processes() lists and stops it.')
    if chosen.stand_in:
        print(_stand_in_note(chosen))
    process.show_output()
    return None


def _stand_in_note(chosen: Executable) -> str:
    return (
        f'({chosen.package} is not installed here. This {chosen.path.name} comes with labkit and '
        'does the same.)'
    )


def _arguments(parser: Parser) -> None:
    parser.add(
        '--prefix',
        help='Prefix command, which should go before the executable. Command must be wrapped in '
        "quotes if it contains spaces (e.g. --prefix 'gdb -ex run --args').",
    )
    parser.add(
        'package_name',
        help='Name of the ROS package',
        complete=lambda _: with_executables(),
    )
    parser.add(
        'executable_name',
        help='Name of the executable',
        complete=lambda args: [one.path.name for one in executables(args.package_name)],
    )
    rest = parser.add(
        'argv', nargs=argparse.REMAINDER, help='Pass arbitrary arguments to the executable'
    )
    rest.required = False  # otherwise errors about the other two name it too


COMMAND = Command(
    'run',
    'Run a package specific executable',
    (Verb('run', 'Run a package specific executable', run, _arguments),),
)
