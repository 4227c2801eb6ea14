"""Start a program of the learner's as a process of its own, and say what becomes of it."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from labkit.background.child_processes import Process

__all__ = ['last_program', 'start_program']

# How long a program may take until its node is in the graph, or it has ended, s.
START_SEC = 20.0
# How many of its last lines are shown once it has ended.
LAST_LINES = 10

_last: Process | None = None


def start_program(program: str) -> Process:
    """Start Python with a program, and wait until its node is there, or it has ended.

    One that an earlier call has started is ended first. It ends with this notebook, too.

    Args:
        program: The text of the program.

    Returns:
        The process; `stop()` ends it.
    """
    global _last
    from labkit.background.child_processes import environment, start_process
    from labkit.background.runtime import runtime
    from labkit.rosgraph.snapshot import node_names

    runtime.start()
    if _last is not None:
        _last.stop()
    assert runtime.helper is not None
    before = node_names(runtime.helper)
    command = [sys.executable, '-c', program]
    process = _last = start_process('the program', command, environment())
    process.wait_for_nodes(runtime.helper, before, START_SEC)
    if process.running:
        names = ', '.join(process.nodes)
        print(f'The program runs, with the node {names}.' if names else 'The program runs.')
        process.show_output()
    else:
        print(*process.output[-LAST_LINES:], sep='\n')
        print(f'The program has ended, with exit code {process.exit_code}.')
    return process


def last_program() -> Process | None:
    """Return the process that was started last, None if there was none."""
    return _last
