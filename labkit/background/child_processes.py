"""Processes of their own that a notebook starts, as with `%ros2 run`: `lab.processes()`.

Their output appears under the cell that started them. They end with the kernel, see `supervisor`.
"""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import threading
import time
from collections import Counter, deque
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING

from labkit import settings
from labkit.background.children import SUPERVISOR
from labkit.background.console import Cell
from labkit.background.discovery import calm, has_all_services
from labkit.background.program import READY
from labkit.background.runtime import runtime
from labkit.background.service_calls import wait_until_spun
from labkit.errors import LabTimeout
from labkit.rosgraph.listings import ends_of_node
from labkit.rosgraph.names import is_hidden
from labkit.rosgraph.snapshot import is_whole, node_names
from labkit.rosgraph.whose import note_end, process_id, process_of

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = [
    'Process',
    'Processes',
    'end_earlier',
    'environment',
    'processes',
    'start_process',
]

# How many lines of output are kept.
MAX_LINES = 1000
# The supervisor gives the command 6 s to end by itself.
STOP_SEC = 8.0
# How long the graph may take to notice that a process has ended. Mostly it says goodbye; where
# that is lost, others forget it after 20 s (the lease of a participant, DDSI-RTPS 2.5, 8.5.3).
GONE_SEC = 30.0
POLL_SEC = 0.05
# How long the services of a node that has come are waited for. A node may be made without them.
SERVICES_SEC = 5.0


class Process:
    """A process that this notebook has started.

    Args:
        name: What it is called in lists, such as `'demo_nodes_py talker'`.
        command: The program and its arguments.
        env: Its environment.
        cell: The execution of the cell that starts it.
        announces: Whether it says what its nodes have, as `spin_until_interrupted` does.

    Attributes:
        nodes: Full names of the nodes that appeared when it was started.
        announced: What its nodes have, as `NodeEnds.names` tells it, once it has said so.
    """

    def __init__(
        self,
        name: str,
        command: list[str],
        env: dict[str, str],
        cell: Cell,
        *,
        announces: bool = False,
    ) -> None:
        self.name = name
        self.command = command
        self.cell = cell
        self.nodes: list[str] = []
        self._lines: deque[str] = deque(maxlen=MAX_LINES)
        self._shown = False
        self._announces = announces
        self._lock = threading.Lock()
        reading, writing = os.pipe()
        self._supervisor = subprocess.Popen(
            # Neither site-packages nor variables of Python's change what the supervisor is.
            [sys.executable, '-I', '-S', str(SUPERVISOR), *command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={**env, READY: str(writing)},
            pass_fds=[writing],
            # The stop button interrupts all processes of the kernel's session.
            start_new_session=True,
            text=True,
            encoding='utf-8',
            errors='replace',
        )
        os.close(writing)
        self.announced: dict[str, dict[str, list[str]]] | None = None
        # What the GUIDs of its endpoints start with; mostly one process has all of them.
        self._in_graph: set[bytes] = set()
        self._herald = threading.Thread(target=self._hear, args=(reading,), daemon=True)
        self._herald.start()
        self._reader = threading.Thread(target=self._read, name=f'labkit {name}', daemon=True)
        self._reader.start()

    @property
    def running(self) -> bool:
        """Tell whether it has not ended yet."""
        return self._supervisor.poll() is None

    @property
    def exit_code(self) -> int | None:
        """Return its exit code, None while it runs."""
        return self._supervisor.poll()

    @property
    def output(self) -> list[str]:
        """Return the last lines that it has printed, oldest first."""
        return list(self._lines)

    @property
    def pids(self) -> set[int]:
        """Return the ids of what runs in it, at most 65535 each as in a GUID."""
        import psutil  # type: ignore[import-untyped]

        try:
            children = psutil.Process(self._supervisor.pid).children(recursive=True)
        except psutil.NoSuchProcess:
            return set()
        return {child.pid & 0xFFFF for child in children}

    def owns(self, gid: bytes) -> bool:
        """Tell whether an endpoint is its own.

        Args:
            gid: The endpoint's GUID, as the graph gives it.
        """
        return process_id(gid) in self.pids

    def show_output(self) -> None:
        """Show what it has printed, and from now on prints, under the cell that started it."""
        with self._lock:
            for line in self._lines:
                runtime.console.write_under(self.cell, f'{line}\n')
            self._shown = True

    def wait_for_lines(self, count: int, *, timeout_sec: float | None = 5.0) -> None:
        """Wait until it has printed some lines; `output` holds them.

        Where nothing is shown live, as under nbval, the cell that waits shows these lines.

        Args:
            count: How many lines, from its beginning on.
            timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.

        Raises:
            LabTimeout: It printed fewer.
        """
        endless = timeout_sec is None or timeout_sec < 0
        end = float('inf') if endless else time.monotonic() + (timeout_sec or 0.0)
        while len(self._lines) < count and self._reader.is_alive() and time.monotonic() < end:
            time.sleep(POLL_SEC / 5)
        lines = self.output
        if len(lines) < count:
            state = 'and goes on' if self.running else f'and ended with code {self.exit_code}'
            raise LabTimeout(f'{self.name} printed {len(lines)} of {count} lines, {state}.')
        if settings.audience().same_each_time:
            print(*lines[:count], sep='\n')

    def stop(self) -> None:
        """End it: it is interrupted as by Ctrl-C, and killed if that does not help."""
        assert self._supervisor.stdin is not None
        self._supervisor.stdin.close()
        try:
            self._supervisor.wait(STOP_SEC)
        except subprocess.TimeoutExpired:
            self._supervisor.kill()
            self._supervisor.wait(STOP_SEC)
        # What a process in the background of the command still holds open is not waited for.
        self._reader.join(POLL_SEC * 4)
        self._wait_until_gone()

    def _wait_until_gone(self) -> None:
        """Wait until the graph has noticed, so that the next cell does not see its nodes."""
        helper = runtime.helper
        if helper is None or not self.nodes:
            return

        def is_gone() -> bool:
            named = {*node_names(helper)} & {*self.nodes}
            return not (named or self._in_graph & {process_of(gid) for gid in _gids(helper)})

        runtime.wait(is_gone, GONE_SEC)

    def wait_for_nodes(self, node: Node, before: Collection[str], timeout_sec: float) -> bool:
        """Wait until its nodes are in the graph, with all that they have, or it has ended.

        What a node has comes into the graph piece by piece. A program that announces what that is
        is waited for until all of it is there. Any other is known to offer the services that come
        with every node, and to answer there once it spins; what else it has is there when the
        graph is calm.

        Args:
            node: The node to ask the graph with.
            before: Full names of the nodes that were there before it was started.
            timeout_sec: Seconds to wait for what is known to come.

        Returns:
            Whether all that is known to come is there.
        """
        earlier = Counter(before)

        def appeared() -> list[str]:
            names = (Counter(node_names(node)) - earlier).keys()
            return sorted(name for name in names if not is_hidden(name))

        def known(name: str) -> dict[str, list[str]]:
            return ends_of_node(node, name, include_hidden=True).names()

        def is_complete() -> bool:
            return is_whole(node) and all(
                set(names) <= set(known(name)[kind])
                for name, ends in (self.announced or {}).items()
                for kind, names in ends.items()
            )

        patient_until = time.monotonic()

        def is_there() -> bool:
            nonlocal patient_until
            if self._announces:
                return self.announced is not None and is_complete()
            names = appeared()
            if not names:
                patient_until = time.monotonic() + SERVICES_SEC
                return False
            return time.monotonic() > patient_until or has_all_services(node, names)

        end = time.monotonic() + timeout_sec
        while not (complete := is_there()) and self.running and time.monotonic() < end:
            time.sleep(POLL_SEC / 5)
        self.nodes = appeared()
        self._in_graph = {process_of(gid) for gid in _gids(node) if self.owns(gid)}
        if self.nodes and not self._announces:
            for name in self.nodes:
                wait_until_spun(node, name)
            calm(node)
        return complete

    def _hear(self, pipe: int) -> None:
        with open(pipe, encoding='utf-8') as file, contextlib.suppress(ValueError):
            self.announced = json.load(file)

    def _read(self) -> None:
        assert self._supervisor.stdout is not None
        with self._supervisor.stdout as lines:
            for line in lines:
                with self._lock:
                    self._lines.append(line.rstrip('\n'))
                    if self._shown:
                        runtime.console.write_under(self.cell, line)
        code = self._supervisor.wait()
        if code < 0 or code > 128:  # a signal has ended it, so it may not have said goodbye
            for process in self._in_graph:
                note_end(process)

    def __repr__(self) -> str:
        state = 'running' if self.running else f'ended (exit code {self.exit_code})'
        return f'{self.name}: {", ".join([state, *self.nodes])}'


def _gids(node: Node) -> list[bytes]:
    """Return the GUID of a publisher of each node that the graph knows, ended or not."""
    infos = node.get_publishers_info_by_topic('/parameter_events')
    return [bytes(info.endpoint_gid) for info in infos]


class Processes(list[Process]):
    """Processes in the order in which they were started; shown as a table."""

    def stop(self) -> None:
        """End all of them."""
        for process in self:
            process.stop()

    def __repr__(self) -> str:
        if not self:
            return 'No process was started with %ros2 run.'
        return '\n'.join(f'{number}  {process!r}' for number, process in enumerate(self))


_started = Processes()


def processes() -> Processes:
    """Return the processes that this notebook has started with `%ros2 run`.

    Returns:
        A list; `lab.processes()[0].stop()` ends the first, `lab.processes().stop()` all of them.
        Those that have ended are listed until the notebook starts another one.
    """
    return Processes(_started)


def start_process(
    name: str, command: list[str], env: dict[str, str], *, announces: bool = False
) -> Process:
    """Start a process.

    Args:
        name: What it is called in lists.
        command: The program and its arguments.
        env: Its environment.
        announces: Whether it says what its nodes have, as `spin_until_interrupted` does.
    """
    _started[:] = [process for process in _started if process.running]
    cell = runtime.console.current_cell()
    _started.append(Process(name, command, env, cell, announces=announces))
    return _started[-1]


def environment() -> dict[str, str]:
    """Return the variables for a process: this Python's, ROS's, and readable output."""
    variables = dict(os.environ)
    folder = str(Path(__file__).parents[2])  # so that labkit is found in another folder too
    paths = [folder, *filter(None, [variables.get('PYTHONPATH')])]
    variables['PYTHONPATH'] = os.pathsep.join(paths)
    if settings.in_kernel():
        variables.setdefault('PYTHONUNBUFFERED', '1')
        # The same form as that of the notebook's own nodes.
        variables.setdefault('RCUTILS_CONSOLE_OUTPUT_FORMAT', '[{severity}] [{name}]: {message}')
    return variables


def end_earlier(command: list[str]) -> None:
    """End the process that an earlier run of the same cell has started with the same command.

    Args:
        command: The program and its arguments.
    """
    cell_id = runtime.console.current_cell().cell_id
    for process in _started:
        if process.running and (process.command, process.cell.cell_id) == (command, cell_id):
            process.stop()
