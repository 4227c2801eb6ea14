"""`ros2 run`: start an executable of a package as a process of its own.

In a terminal it runs until it ends or is interrupted, as with the real one. In a notebook it runs
in the background, so that the next cell can watch it.
"""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from argparse import Namespace
from collections.abc import Iterable

from labkit import settings
from labkit.background.child_processes import end_earlier, environment, start_process
from labkit.background.discovery import alone
from labkit.ros2.asking import asking_node
from labkit.ros2.parser import Command, Parser, Verb
from labkit.rosgraph.packages import DEMO, Executable, executable, executables, package_names
from labkit.rosgraph.snapshot import node_names

__all__ = ['COMMAND']

# How long to wait for the node of a process. On a busy machine Python itself takes a while.
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
    process = start_process(name, command, environment(), announces=chosen.stand_in)
    process.wait_for_nodes(node, before, 0.0 if alone() else APPEAR_SEC)
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


def _names(args: Namespace) -> Iterable[str]:
    return [one.path.name for one in executables(args.package_name)]


def _arguments(parser: Parser) -> None:
    parser.add(
        '--prefix',
        help='Prefix command, which should go before the executable. Command must be wrapped in '
        "quotes if it contains spaces (e.g. --prefix 'gdb -ex run --args').",
    )
    parser.add(
        'package_name',
        help='Name of the ROS package',
        complete=lambda _: [*package_names(), DEMO],
    )
    parser.add('executable_name', help='Name of the executable', complete=_names)
    rest = parser.add(
        'argv', nargs=argparse.REMAINDER, help='Pass arbitrary arguments to the executable'
    )
    rest.required = False  # or else a complaint about the other two names it too


COMMAND = Command(
    'run',
    'Run a package specific executable',
    (Verb('run', 'Run a package specific executable', run, _arguments),),
)
