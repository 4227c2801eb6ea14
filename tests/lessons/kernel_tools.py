"""What the proof does inside the kernel: run a script, and clean up after an answer."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
import tempfile
import weakref
from pathlib import Path

import psutil
from rclpy.node import Node

from labkit.background.nodes import existing_nodes
from labkit.background.runtime import remove, runtime

_before: weakref.WeakSet[Node] = weakref.WeakSet()
_foreign_before: set[str] = set()
_children_before: set[int] = set()


def mark() -> None:
    """Remember which nodes and processes belong to the lesson itself."""
    _before.update(existing_nodes())
    _foreign_before.update(runtime.foreign_nodes())
    _children_before.update(child.pid for child in _children())


def run_script(code: str) -> None:
    """Run code as a learner runs a script: in a process of its own."""
    handle, name = tempfile.mkstemp(suffix='.py', text=True)
    with open(handle, 'w') as file:
        file.write(code)
    with Path(name).with_suffix('.log').open('wb') as log:
        process = subprocess.Popen([sys.executable, name], stdout=log, stderr=log)
    # A learner looks at the check only when the script is up.
    runtime.wait(lambda: not _alone() or process.poll() is not None, 25.0)


def clean() -> None:
    """End the processes and nodes that an answer has left behind, and wait until they are gone."""
    processes = [child for child in _children() if child.pid not in _children_before]
    for process in processes:
        with contextlib.suppress(psutil.NoSuchProcess):
            process.send_signal(signal.SIGINT)
    _, busy = psutil.wait_procs(processes, timeout=5)
    for process in busy:
        process.kill()
    psutil.wait_procs(busy)
    for node in existing_nodes():
        if node not in _before and node is not runtime.helper:
            remove(node)
    runtime.wait(_alone, 25.0)


def _alone() -> bool:
    """Tell whether no node of a process besides the lesson's own is in the graph."""
    return runtime.foreign_nodes() <= _foreign_before


def _children() -> list[psutil.Process]:
    return psutil.Process().children(recursive=True)
