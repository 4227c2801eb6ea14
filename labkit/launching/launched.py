"""Launches of a notebook: `lab.launch` and `%ros2 launch`."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from labkit.asking.discovery import asking_node, is_only_process
from labkit.background.console import Cell
from labkit.background.runtime import runtime
from labkit.background.wait import wait_for
from labkit.errors import LabError
from labkit.launching.launch_files import find
from labkit.programs.child_environment import environment
from labkit.programs.child_processes import Process, gids_in, keep, processes
from labkit.rosgraph.snapshot import is_whole, node_names
from labkit.rosgraph.whose import note_end, process_id, process_of

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ['Launch', 'Program', 'launch', 'start']

# Time for the programs of a launch to be started, and for their nodes to appear. On a busy machine
# Python itself takes a while.
BEGIN_SEC = 30.0


@dataclass
class Program:
    """A program that a launch has started.

    Attributes:
        name: What its output is marked with, such as `'talker-1'`.
        exit_code: Its exit code, None while it runs; below 0 the signal that has ended it.
        starts: How often it was started.
        is_node: Whether the launch file calls it a node.
        again: Whether it has ended, and is about to be started again.
        left: How often it might be started again when it ended last; below 0 without end.
        delay: How long after its end it is started again then, s.
    """

    name: str
    pid: int
    exit_code: int | None = None
    starts: int = 1
    is_node: bool = False
    again: bool = False
    left: int = -1
    delay: float = 0.0

    def __repr__(self) -> str:
        state = 'running' if self.exit_code is None else f'ended (exit code {self.exit_code})'
        more = f', started {self.starts} times' if self.starts > 1 else ''
        return f'{self.name}: {state}{more}'


class Launch(Process):
    """A launch file that runs in the background.

    Attributes:
        path: The launch file.
        processes: The programs that it has started, in that order.
        shutting_down: Whether it was ending all of them when the last one ended.
        timers: The periods of its timers that have not fired yet, s.
    """

    def __init__(self, name: str, path: str, arguments: Mapping[str, str], cell: Cell) -> None:
        self.path = path
        self.processes: list[Program] = []
        self.shutting_down = False
        self.timers: list[float] = []
        self._ready = False
        self._fault: LabError | None = None
        command = [sys.executable, '-m', 'labkit.ros2', 'launch', '--noninteractive', path]
        command += [f'{key}:={text}' for key, text in arguments.items()]
        super().__init__(name, command, environment(), cell)

    @property
    def summary(self) -> str:
        """A sentence that says what runs."""
        running = [one.name for one in self.processes if one.exit_code is None]
        if not self.running:
            return f'{self.name} has ended: exit code {self.exit_code}.'
        what = f', with {", ".join(running)}' if running else ''
        return f'{self.name} runs in the background{what}. lab.processes() lists and stops it.'

    def wait_until_begun(self, node: Node, before: list[str]) -> None:
        """Wait until all that it starts at once is there, with its nodes in the graph.

        Raises:
            LabError: Something is wrong in the launch file; nothing was started.
        """
        try:
            wait_for(lambda: self._ready or not self.running, BEGIN_SEC)
        finally:
            late = not self._ready and self.running
            if late:
                self.stop()
        if not self.running:
            self._listener.join()
        if late:
            raise LabError(
                f'{self.name} was ended: it has begun nothing in {BEGIN_SEC:g} s.',
                todo='A launch file only describes what to start; look for a loop in it.',
            )
        if not self._ready:
            raise self._fault or LabError(
                f'{self.name} has not begun.', todo='\n'.join(self.output)
            )
        nodes = any(one.is_node for one in self.processes)
        if nodes:
            self.wait_for_nodes(node, before, 0.0 if is_only_process() else BEGIN_SEC)

    def _hear(self, announcement: dict[str, Any]) -> None:
        if 'started' in announcement:
            self._note_start(announcement)
        elif 'ended' in announcement:
            program = self._program(announcement['ended'])
            if announcement['exit_code'] < 0:
                self._note_killed(program.pid)
            program.again, program.left = announcement['again'], announcement['left']
            program.delay = announcement['delay']
            self.shutting_down = announcement['shutting_down']
            program.exit_code = announcement['exit_code']
        elif 'timers' in announcement:
            self.timers = announcement['timers']
        elif 'fault' in announcement:
            self._fault = LabError(announcement['fault'], todo=announcement['todo'])
        self._ready = self._ready or 'ready' in announcement

    def _note_start(self, told: dict[str, Any]) -> None:
        for program in self.processes:
            if program.name == told['started']:
                program.pid, program.exit_code = told['pid'], None
                program.starts, program.again = program.starts + 1, False
                return
        self.processes.append(Program(told['started'], told['pid'], is_node=told['node']))

    def _note_killed(self, pid: int) -> None:
        """Leave a killed program out of the graph, which would have it for another 20 s."""
        for gid in gids_in(runtime.helper) if runtime.helper is not None else ():
            if process_id(gid) == pid & 0xFFFF:
                note_end(process_of(gid))
                self._in_graph.discard(process_of(gid))

    def _program(self, name: str) -> Program:
        return next(program for program in self.processes if program.name == name)

    def _has_begun(self, node: Node) -> bool:
        wanted = {
            program.pid & 0xFFFF
            for program in self.processes
            if program.is_node and program.exit_code is None
        }
        # The endpoints of a node are known before its name is.
        return wanted <= {process_id(gid) for gid in gids_in(node)} and is_whole(node)

    def __repr__(self) -> str:
        # Without its nodes: a program that has ended, or runs again, has others by now.
        state = 'running' if self.running else f'ended (exit code {self.exit_code})'
        return '\n'.join([f'{self.name}: {state}', *(f'  {one!r}' for one in self.processes)])


def launch(*target: str | os.PathLike[str], **arguments: object) -> Launch:
    """Start what a launch file describes, in the background.

    What its programs show appears under the cell. When the cell runs again, the earlier launch
    ends first; with the notebook it ends, too.

    Args:
        target: The path of the file, or the name of a package and of a launch file in it.
        arguments: Values of its arguments.

    Returns:
        The launch: `processes` lists its programs, and `stop()` ends them all.

    Raises:
        LabError: Something is wrong in the file. Nothing was started.
    """
    if len(target) not in (1, 2):
        raise LabError(
            f'lab.launch takes a file, or a package and a file, and got {len(target)} names.',
            todo="lab.launch('robots.launch.xml', count=2)",
        )
    names = [os.fspath(name) for name in target]
    path = names[0] if len(names) == 1 else find(*names)
    texts = {name: _text(value) for name, value in arguments.items()}
    return start(path, texts, name=' '.join(['launch of', *names]))


def start(path: str, arguments: Mapping[str, str], *, name: str) -> Launch:
    """Start a launch in the background, and wait until it has begun.

    Raises:
        LabError: Something is wrong in the file. Nothing was started.
    """
    node = asking_node()
    path = os.path.abspath(path)
    cell = runtime.console.current_cell()
    for earlier in processes():
        same = isinstance(earlier, Launch) and earlier.path == path
        if same and earlier.running and earlier.cell.cell_id == cell.cell_id:
            earlier.stop()
    before = node_names(node)
    process = keep(Launch(name, path, arguments, cell))
    process.wait_until_begun(node, before)
    process.show_output()
    return process


def _text(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
