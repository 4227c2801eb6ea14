"""Start a program of the learner's as a process of its own, and say what becomes of it."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from labkit.exercises.probe import Probe
    from labkit.programs.child_processes import Process

__all__ = ['ended_program', 'start_program']

# How long a program may take until its node is in the graph, or it has ended, s.
START_SEC = 20.0
# How many of its last lines are shown once it has ended.
LAST_LINES = 10

_last: Process | None = None
# When it was started, in seconds since 1970.
_started = 0.0


def start_program(program: str) -> Process:
    """Start Python with a program, and wait until its node is there, or it has ended.

    One that an earlier call has started is ended first. It ends with this notebook, too.

    Args:
        program: The text of the program.

    Returns:
        The process; `stop()` ends it.
    """
    global _last, _started
    from labkit.background.runtime import runtime
    from labkit.programs.child_processes import environment, start_process
    from labkit.rosgraph.snapshot import node_names

    runtime.start()
    if _last is not None:
        _last.stop()
    assert runtime.helper is not None
    before = node_names(runtime.helper)
    command = [sys.executable, '-c', program]
    _started = time.time()
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


def ended_program(probe: Probe) -> Process | None:
    """Return the program that was started last, if it has ended and no process was started since.

    A process may be started in another way, too. One whose node has left the graph is waited for:
    a program ends a moment after its node.
    """
    import psutil  # type: ignore[import-untyped]

    from labkit.programs.child_processes import gids_in

    program = _last
    if program is None:
        return None
    if program.nodes:
        probe.wait(lambda: not program.running or any(map(program.owns, gids_in(probe.node))))
    if program.running:
        return None
    children = psutil.Process().children()
    later = (child for child in children if child.create_time() > _started)
    return None if any(child.status() != psutil.STATUS_ZOMBIE for child in later) else program
