"""Processes that a notebook starts, as with `%ros2 run`: `lab.processes()`.

Their output appears under the cell that started them. They end with the kernel, see `supervisor`.
"""

from __future__ import annotations

import codecs
import contextlib
import io
import json
import os
import select
import subprocess
import sys
import threading
import time
from collections import Counter, deque
from collections.abc import Collection
from typing import TYPE_CHECKING, Any, TypeVar

from labkit import settings
from labkit.asking.discovery import has_all_services, wait_until_announced
from labkit.asking.service_calls import wait_until_spun
from labkit.background.console import Cell
from labkit.background.runtime import runtime
from labkit.background.wait import wait_for
from labkit.errors import LabTimeout
from labkit.programs.child_environment import READY, environment
from labkit.programs.children import SUPERVISOR
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
    'gids_in',
    'keep',
    'processes',
    'start_process',
]

# Number of lines of output to keep.
MAX_LINES = 1000
# As much as a pipe can hold.
MAX_BYTES = 2**20
# The supervisor gives the command 6 s to end by itself.
STOP_SEC = 8.0
# How long the graph may take to notice that a process has ended. Normally it says goodbye; if that
# is lost, others forget it after 20 s (the lease of a participant, DDSI-RTPS 2.5, 8.5.3).
GONE_SEC = 30.0
# A background process of the command may keep its output open for ever.
READ_SEC = 0.2
# How long to wait for the services of a new node. A node may be made without them.
SERVICES_SEC = 5.0
# How long until a node answers, which a program that loads types first does late. Some never do.
SPUN_SEC = 2.0


AnyProcess = TypeVar('AnyProcess', bound='Process')


class Process:
    """A process that this notebook has started.

    Args:
        name: Its name in lists, such as `'demo_nodes_py talker'`.
        command: The program and its arguments.
        env: Its environment.
        cell: The execution of the cell that starts it.
        announces: Whether it announces its nodes, as `spin_until_interrupted` does.

    Attributes:
        nodes: Full names of the nodes that appeared when it was started, none if it ended first.
        announced: The endpoints of its nodes as in `NodeEnds.names`, None until announced.
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
        self._appeared: list[str] = []
        self._lines: deque[str] = deque(maxlen=MAX_LINES)
        # The parts of a line that has not ended yet, and lines that the reader has to show.
        self._parts: list[str] = []
        self._unshown: list[str] = []
        self._at_end = False
        utf8 = codecs.getincrementaldecoder('utf-8')(errors='replace')
        self._decoder = io.IncrementalNewlineDecoder(utf8, translate=True)
        self._shown = False
        self._announces = announces
        self._lock = threading.Lock()
        reading, writing = os.pipe()
        self._supervisor = subprocess.Popen(
            # Neither site-packages nor Python's environment variables affect the supervisor.
            [sys.executable, '-I', '-S', str(SUPERVISOR), *command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={**env, READY: str(writing)},
            pass_fds=[writing],
            # The stop button interrupts all processes of the kernel's session.
            start_new_session=True,
        )
        os.close(writing)
        assert self._supervisor.stdout is not None
        os.set_blocking(self._supervisor.stdout.fileno(), False)
        self.announced: dict[str, dict[str, list[str]]] | None = None
        # GUID prefixes of its processes in the graph, usually one.
        self._in_graph: set[bytes] = set()
        self._listener = threading.Thread(
            target=self._read_announcement, args=(reading,), daemon=True
        )
        self._listener.start()
        self._reader = threading.Thread(target=self._read, name=f'labkit {name}', daemon=True)
        self._reader.start()

    @property
    def running(self) -> bool:
        """Return whether it is running."""
        return self._supervisor.poll() is None

    @property
    def exit_code(self) -> int | None:
        """Return its exit code, None while it runs."""
        return self._supervisor.poll()

    @property
    def output(self) -> list[str]:
        """Return its last lines of output, oldest first; all of them once it has ended."""
        if not self.running:
            # Its reader may have had no turn yet. After all that a pipe can hold comes the end.
            self._take()
            self._take()
        return list(self._lines)

    @property
    def pids(self) -> set[int]:
        """Return the lower 16 bits of its process ids, as in a GUID."""
        import psutil  # type: ignore[import-untyped]

        try:
            children = psutil.Process(self._supervisor.pid).children(recursive=True)
        except psutil.NoSuchProcess:
            return set()
        return {child.pid & 0xFFFF for child in children}

    def owns(self, gid: bytes) -> bool:
        """Return whether it owns the endpoint of a GUID."""
        return process_id(gid) in self.pids

    def show_output(self) -> None:
        """Show its past and future output under the cell that started it."""
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
        wait_for(
            lambda: len(self._lines) >= count or not self._reader.is_alive(),
            None if endless else timeout_sec,
        )
        lines = self.output
        if len(lines) < count:
            state = 'and goes on' if self.running else f'and ended with code {self.exit_code}'
            raise LabTimeout(f'{self.name} printed {len(lines)} of {count} lines, {state}.')
        if settings.audience().same_each_time:
            print(*lines[:count], sep='\n')

    def stop(self) -> None:
        """Interrupt it as by Ctrl-C, and kill it if that does not help."""
        assert self._supervisor.stdin is not None
        self._supervisor.stdin.close()
        try:
            self._supervisor.wait(STOP_SEC)
        except subprocess.TimeoutExpired:
            self._supervisor.kill()
            self._supervisor.wait(STOP_SEC)
        self._reader.join(READ_SEC)
        self._wait_until_gone()

    def _wait_until_gone(self) -> None:
        """Wait until its nodes have left the graph, so that the next cell does not see them."""
        helper = runtime.helper
        if helper is None or not self._appeared:
            return

        def is_gone() -> bool:
            named = {*node_names(helper)} & {*self._appeared}
            return not (named or self._in_graph & {process_of(gid) for gid in gids_in(helper)})

        runtime.wait(is_gone, GONE_SEC)

    def wait_for_nodes(self, node: Node, before: Collection[str], timeout_sec: float) -> bool:
        """Wait until its nodes are in the graph with all of their endpoints, or it has ended.

        Endpoints are discovered one by one. If the program announces them, this waits for all of
        them. Otherwise it waits for the standard services of each node and an answer from them,
        and then for what it has announced to ROS by then.

        Args:
            node: The node for graph queries.
            before: Full names of the nodes in the graph before it was started.
            timeout_sec: Seconds to wait for the announced endpoints, or the first node.

        Returns:
            Whether the announced endpoints, or the standard services, are there.
        """
        earlier = Counter(before)

        def appeared() -> list[str]:
            names = (Counter(node_names(node)) - earlier).keys()
            return sorted(name for name in names if not is_hidden(name))

        def discovered(name: str) -> dict[str, list[str]]:
            return ends_of_node(node, name, include_hidden=True).names()

        def is_complete() -> bool:
            return is_whole(node) and all(
                set(names) <= set(discovered(name)[kind])
                for name, ends in (self.announced or {}).items()
                for kind, names in ends.items()
            )

        patient_until = time.monotonic()

        def is_there() -> bool:
            nonlocal patient_until
            if self._announces:
                return self.announced is not None and is_complete()
            names = appeared()
            if not names or not self._has_begun(node):
                patient_until = time.monotonic() + SERVICES_SEC
                return False
            return time.monotonic() > patient_until or has_all_services(node, names)

        wait_for(lambda: is_there() or not self.running, timeout_sec)
        complete = is_there()
        self._appeared = appeared()
        self.nodes = list(self._appeared) if self.running else []
        self._in_graph = {process_of(gid) for gid in gids_in(node) if self.owns(gid)}
        if self.nodes and not self._announces:
            for name in self.nodes:
                wait_until_spun(node, name, SPUN_SEC)
            wait_until_announced(node)
        return complete

    def _has_begun(self, node: Node) -> bool:
        """Return whether each of its programs has nodes in the graph."""
        return True

    def _read_announcement(self, pipe: int) -> None:
        with open(pipe, encoding='utf-8') as file, contextlib.suppress(ValueError):
            for line in file:
                self._hear(json.loads(line))

    def _hear(self, announcement: dict[str, Any]) -> None:
        """Take what the process announces: its nodes."""
        self.announced = announcement

    def _read(self) -> None:
        assert self._supervisor.stdout is not None
        with self._supervisor.stdout as pipe:
            news = select.poll()
            news.register(pipe)
            at_end = False
            while not at_end:
                news.poll()  # at the end it returns at once
                self._take()
                with self._lock:
                    at_end, unshown, self._unshown = self._at_end, self._unshown, []
                for line in unshown:
                    runtime.console.write_under(self.cell, line)
        code = self._supervisor.wait()
        if code < 0 or code > 128:  # ended by a signal, so it may not have said goodbye
            for process in self._in_graph:
                note_end(process)

    def _take(self) -> None:
        """Take the output that is there. Only the reader shows it: a thread has one cell."""
        assert self._supervisor.stdout is not None
        with self._lock, contextlib.suppress(BlockingIOError):
            if self._at_end or self._supervisor.stdout.closed:
                return
            data = os.read(self._supervisor.stdout.fileno(), MAX_BYTES)
            self._at_end = not data
            *ends, rest = self._decoder.decode(data, final=self._at_end).split('\n')
            for end in ends:
                self._note_line(end, '\n')
            self._parts.append(rest)
            if self._at_end and any(self._parts):
                self._note_line('', '')

    def _note_line(self, end: str, newline: str) -> None:
        line = ''.join([*self._parts, end])
        self._parts.clear()
        self._lines.append(line)
        if self._shown:
            self._unshown.append(line + newline)

    def __repr__(self) -> str:
        state = 'running' if self.running else f'ended (exit code {self.exit_code})'
        return f'{self.name}: {", ".join([state, *self.nodes])}'


def gids_in(node: Node) -> list[bytes]:
    """Return the GUID of a publisher of each node in the graph, ended or not."""
    infos = node.get_publishers_info_by_topic('/parameter_events')
    return [bytes(info.endpoint_gid) for info in infos]


class Processes(list[Process]):
    """Processes in the order they were started; shown as a table."""

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
    """Start a process; arguments as those of `Process`."""
    cell = runtime.console.current_cell()
    return keep(Process(name, command, env, cell, announces=announces))


def keep(process: AnyProcess) -> AnyProcess:
    """Note a process that was started, so that `lab.processes()` has it."""
    _started[:] = [one for one in _started if one.running]
    _started.append(process)
    return process


def end_earlier(command: list[str]) -> None:
    """End the process that an earlier run of this cell has started with the same command."""
    cell_id = runtime.console.current_cell().cell_id
    for process in _started:
        if process.running and (process.command, process.cell.cell_id) == (command, cell_id):
            process.stop()
