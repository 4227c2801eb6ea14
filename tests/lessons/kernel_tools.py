"""What is done inside the kernel: run a script, press stop, clean up after an answer."""

from __future__ import annotations

import ast
import contextlib
import gc
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import weakref
from hashlib import sha256
from pathlib import Path
from typing import Any

import psutil
from IPython.core.getipython import get_ipython
from rclpy.node import Node

from labkit.background.nodes import existing_nodes
from labkit.background.runtime import remove, runtime
from labkit.background.wait import wait_for
from labkit.packages import workspace
from labkit.rosgraph.names import UNKNOWN_NODE, full_node_name
from labkit.rosgraph.whose import process_id

# Generous: it is there to end a hang. An answer's callback may never return, so `wait_for` does
# not look between callbacks, as `runtime.wait` does.
TIMEOUT_SEC = 60.0

_HERE = Path(__file__).resolve().parent
_colcon = workspace.colcon

_before: weakref.WeakSet[Node] = weakref.WeakSet()
_foreign_before: set[str] = set()
_children_before: set[int] = set()
_files_before: dict[Path, bytes | None] = {}
_names_before: dict[str, Any] = {}
_scripts: list[subprocess.Popen[bytes]] = []


def mark() -> None:
    """Remember which nodes, processes, files and names belong to the lesson itself."""
    _build_once()
    gc.collect()  # a process that has ended is an attempt as long as there is an object of it
    _before.update(existing_nodes())
    _foreign_before.update(runtime.foreign_nodes())
    _children_before.update(child.pid for child in _children())
    _files_before.update({path: _content(path) for path in _files()})
    _names_before.clear()
    _names_before.update(_names())


def _build_once() -> None:
    """Let `colcon` be the one of `built_once`, and `lab.build` build the same text once.

    `python3` is that of the environment, as in a terminal of JupyterLab.
    """
    workspace.colcon = _colcon_once
    first = [str(_HERE / '.colcon'), str(Path(sys.executable).parent)]
    paths = os.environ.get('PATH', os.defpath).split(os.pathsep)
    os.environ['PATH'] = os.pathsep.join([*first, *(path for path in paths if path not in first)])


def _colcon_once(folder: Path, packages: list[str], **options: Any) -> None:
    """Do what `workspace.colcon` does; of the same text it is there already, as it was built."""
    text = [(path, path.read_bytes()) for path in sorted(folder.rglob('src/**/*.*'))]
    kept = _HERE / '.colcon' / sha256(repr(text).encode()).hexdigest()
    if not kept.is_dir():
        _colcon(folder, packages, **options)
        for name in ('build', 'install'):
            shutil.copytree(folder / name, kept / name, symlinks=True)
    else:
        shutil.copytree(kept, folder, symlinks=True, dirs_exist_ok=True)


def run_script(code: str) -> None:
    """Run code as a learner runs a script: in a process of its own."""
    handle, name = tempfile.mkstemp(suffix='.py', text=True)
    with open(handle, 'w') as file:
        file.write(code)
    with Path(name).with_suffix('.log').open('wb') as log:
        process = subprocess.Popen([sys.executable, name], stdout=log, stderr=log)
    _scripts.append(process)
    # A learner looks at the check only when the script is up.
    up = wait_for(lambda: _nodes_of(process.pid) or process.poll() is not None, TIMEOUT_SEC)
    assert up, f'no node of {process.pid} in {_graph()}: {Path(log.name).read_text()}'


def clean() -> None:
    """End the processes and nodes that an answer has left behind, and wait until they are gone.

    Files that it has written are removed, so that the next one has to write its own. Those that
    it has changed are as before.
    """
    _end_processes()
    for script in _scripts:
        script.wait()
    _scripts.clear()
    for node in existing_nodes():
        if node not in _before and node is not runtime.helper:
            remove(node)
    # Between two callbacks: one of the last answer may sleep, and is not to be taken for the next.
    if not runtime.wait(_alone, 25.0):
        _end_processes()  # one that a shell was about to start
    assert wait_for(_alone, TIMEOUT_SEC), f'there are still others in {_graph()}'
    for path in sorted(_files() - _files_before.keys(), reverse=True):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)  # with its hidden files
        else:
            path.unlink()
    for path, content in _files_before.items():
        if content is not None and content != _content(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)


def _end_processes() -> None:
    processes = [child for child in _children() if child.pid not in _children_before]
    for process in processes:
        with contextlib.suppress(psutil.NoSuchProcess):
            process.send_signal(signal.SIGINT)
    _, busy = psutil.wait_procs(processes, timeout=5)
    for process in busy:
        process.kill()
    psutil.wait_procs(busy)


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


def left_of_check() -> dict[str, Any]:
    """Return all that a check changes, as it is now."""
    helper = runtime.helper
    nodes = existing_nodes()
    return {
        'clocks': sorted(node.get_fully_qualified_name() for node in nodes if _is_set(node)),
        'nodes': sorted(_living_nodes()),
        'ends on /clock': helper.count_publishers('/clock') + helper.count_subscribers('/clock'),
        'clients': len(list(helper.clients)),
        'processes': len(_children()),
        'threads': sorted(t.name for t in threading.enumerate() if t.name.startswith('labkit')),
        'output': runtime.console._held,
        'switch interval': sys.getswitchinterval(),
        'handler': str(signal.getsignal(signal.SIGINT)),
    }


def wait_until_left(text: str) -> dict[str, Any]:
    """Wait until `left_of_check` is this: another process may take long to leave the graph."""
    wait_for(lambda: left_of_check() == ast.literal_eval(text), 25.0)
    return left_of_check()


def _is_set(node: Node) -> bool:
    clock: Any = node.get_clock()
    return bool(clock.ros_time_is_active)


def _names() -> dict[str, Any]:
    """Return what cells have defined; IPython's own names begin with `_`, or are its tools."""
    names = get_ipython().user_ns
    return {name: value for name, value in names.items() if name.isidentifier() and name[0] != '_'}


def _files() -> set[Path]:
    """Return the files and folders beside the notebook; the hidden ones are not an answer's."""
    return {path for path in Path().rglob('[!.]*') if not path.parts[0].startswith('.')}


def _content(path: Path) -> bytes | None:
    return path.read_bytes() if path.is_file() else None


def _nodes_of(pid: int) -> list[str]:
    """Return the nodes of a process that are in the graph: a GUID holds the id of its process."""
    infos = runtime.helper.get_publishers_info_by_topic('/parameter_events')
    return [
        full_node_name(info.node_name, info.node_namespace)
        for info in infos
        if process_id(bytes(info.endpoint_gid)) == pid & 0xFFFF and info.node_name != UNKNOWN_NODE
    ]


def _living_nodes() -> list[str]:
    """Return the names of nodes whose process lives: the graph forgets killed ones after 20 s."""
    found = psutil.process_iter(['status'])
    living = {p.pid & 0xFFFF for p in found if p.info['status'] != psutil.STATUS_ZOMBIE}
    infos = runtime.helper.get_publishers_info_by_topic('/parameter_events')
    return [i.node_name for i in infos if process_id(bytes(i.endpoint_gid)) in living]


def _graph() -> str:
    infos = runtime.helper.get_publishers_info_by_topic('/parameter_events')
    ends = [(i.node_namespace, i.node_name, bytes(i.endpoint_gid).hex()) for i in infos]
    nodes = runtime.helper.get_node_names_and_namespaces()
    children = [(child.pid, child.status(), *child.cmdline()[:2]) for child in _children()]
    return f'the graph of {nodes}, with {ends}, beside the processes {children}'


def _alone() -> bool:
    """Tell whether no node of a process besides the lesson's own is in the graph."""
    return runtime.foreign_nodes() <= _foreign_before


def _children() -> list[psutil.Process]:
    """Return the processes of this kernel, with those that a shell has left behind."""
    own = psutil.Process()
    children = own.children(recursive=True)
    for process in psutil.process_iter():
        with contextlib.suppress(ProcessLookupError, psutil.Error):
            # A shell that has ended leaves them to nobody, and to a group of its own.
            is_ours = os.getpgid(process.pid) == os.getpgrp() or process.cwd() == str(_HERE)
            if is_ours and process != own:
                children.append(process)
    return list(dict.fromkeys(children))
