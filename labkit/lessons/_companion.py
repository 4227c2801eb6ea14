"""A process that a lesson starts beside the notebook, such as its stadium or its harbour."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from labkit.errors import LabTimeout

if TYPE_CHECKING:
    from labkit.programs.child_processes import Process

__all__ = ['start_companion']

START_SEC = 25.0
# So many of its last lines are shown if it ends at once.
SHOWN_LINES = 5


def start_companion(name: str, module: str, earlier: Process | None) -> Process:
    """Start the function `main()` of a module as a process, and wait until its nodes are there.

    Args:
        name: What it is called in the list of `lab.processes()`.
        module: Name of the module. Its nodes say what they have: `spin_until_interrupted`.
        earlier: The one that was started before, which is ended first.

    Returns:
        The process.

    Raises:
        LabTimeout: Its nodes did not come.
    """
    from labkit.background.runtime import runtime
    from labkit.programs.child_processes import environment, start_process
    from labkit.rosgraph.snapshot import node_names

    if earlier is not None:
        earlier.stop()
    runtime.start()
    assert runtime.helper is not None
    before = node_names(runtime.helper)
    command = [sys.executable, '-c', f'from {module} import main; main()']
    process = start_process(name, command, environment(), announces=True)
    if process.wait_for_nodes(runtime.helper, before, START_SEC):
        return process
    if process.running:
        seen = f'Waited {START_SEC:.0f} s for the nodes of the {name}, but they did not come.'
    else:
        said = '\n'.join(['', *process.output[-SHOWN_LINES:]])
        seen = f'The {name} ended with code {process.exit_code} before its nodes came.{said}'
    process.stop()
    raise LabTimeout(
        seen, todo='Run the cell again. If that does not help, lab.doctor() looks for the reason.'
    )
