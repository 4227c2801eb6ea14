"""What is done inside the kernel: run a script, press stop, clean up after an answer."""

from __future__ import annotations

import contextlib
import gc
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import weakref
from pathlib import Path
from typing import Any

import psutil
from IPython import get_ipython
from rclpy.node import Node

from labkit.background.nodes import existing_nodes
from labkit.background.runtime import runtime
from labkit.background.spinning import remove

_before: weakref.WeakSet[Node] = weakref.WeakSet()
_foreign_before: set[str] = set()
_children_before: set[int] = set()
_files_before: set[Path] = set()
_names_before: dict[str, Any] = {}
_scripts: list[subprocess.Popen[bytes]] = []


def mark() -> None:
    """Remember which nodes, processes, files and names belong to the lesson itself."""
    gc.collect()  # a process that has ended is an attempt as long as there is an object of it
    _before.update(existing_nodes())
    _foreign_before.update(runtime.foreign_nodes())
    _children_before.update(child.pid for child in _children())
    _files_before.update(_files())
    _names_before.clear()
    _names_before.update(_names())


def run_script(code: str) -> None:
    """Run code as a learner runs a script: in a process of its own."""
    handle, name = tempfile.mkstemp(suffix='.py', text=True)
    with open(handle, 'w') as file:
        file.write(code)
    with Path(name).with_suffix('.log').open('wb') as log:
        process = subprocess.Popen([sys.executable, name], stdout=log, stderr=log)
    _scripts.append(process)
    # A learner looks at the check only when the script is up.
    runtime.wait(lambda: not _alone() or process.poll() is not None, 25.0)


def clean() -> None:
    """End the processes and nodes that an answer has left behind, and wait until they are gone.

    Files that it has written are removed, so that the next one has to write its own.
    """
    processes = [child for child in _children() if child.pid not in _children_before]
    for process in processes:
        with contextlib.suppress(psutil.NoSuchProcess):
            process.send_signal(signal.SIGINT)
    _, busy = psutil.wait_procs(processes, timeout=5)
    for process in busy:
        process.kill()
    psutil.wait_procs(busy)
    for script in _scripts:
        script.wait()
    _scripts.clear()
    for node in existing_nodes():
        if node not in _before and node is not runtime.helper:
            remove(node)
    runtime.wait(_alone, 25.0)
    for path in sorted(_files() - _files_before, reverse=True):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)  # with its hidden files
        else:
            path.unlink()


def forget_names() -> None:
    """Take back what an answer has defined, so that the next one can't use it by mistake."""
    names = get_ipython().user_ns
    for name in _names().keys() - _names_before.keys():
        del names[name]
    names.update(_names_before)


def stop_next_cell_after(seconds: float) -> None:
    """Press the stop button if the next cell runs as long as that."""
    button = threading.Timer(seconds, signal.pthread_kill, (threading.get_ident(), signal.SIGINT))
    button.daemon = True
    events = get_ipython().events

    def begin(_info: object) -> None:
        events.unregister('pre_run_cell', begin)
        events.register('post_run_cell', end)
        button.start()

    def end(_result: object) -> None:
        events.unregister('post_run_cell', end)
        button.cancel()

    events.register('pre_run_cell', begin)


def _names() -> dict[str, Any]:
    """Return what cells have defined; IPython's own names begin with `_`, or are its tools."""
    names = get_ipython().user_ns
    return {name: value for name, value in names.items() if name.isidentifier() and name[0] != '_'}


def _files() -> set[Path]:
    """Return the files and folders beside the notebook; the hidden ones are not an answer's."""
    return {path for path in Path().rglob('[!.]*') if not path.parts[0].startswith('.')}


def _alone() -> bool:
    """Tell whether no node of a process besides the lesson's own is in the graph."""
    return runtime.foreign_nodes() <= _foreign_before


def _children() -> list[psutil.Process]:
    return psutil.Process().children(recursive=True)
