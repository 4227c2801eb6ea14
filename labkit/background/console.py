"""Show prints, ROS logs and errors of callbacks under the cell that started their node.

A kernel sends the output of a background thread to whichever cell ran last. Here every node has
the cell that started it, and while one of its callbacks runs, the background thread's output goes
to that cell.

ROS logs are intercepted where rclpy passes them to its logging library, and printed, so they stay
in order with the prints of a callback. (rcl's own console output is written by C code to the file
descriptor: it is lost under nbval, and its order with prints is undefined. The records on /rosout
arrive later, through the middleware.) /rosout itself works as always.
"""

from __future__ import annotations

import io
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any, TextIO

from labkit import progress_bar, settings
from labkit.background import compat, tracebacks
from labkit.background.log_box import LogBox
from labkit.background.tracebacks import short_traceback

__all__ = ['MAX_LINES', 'CallbackError', 'Cell', 'Console']

MAX_LINES = 200
# Most characters of a line to show: a page can't cope with a megabyte in one line.
MAX_CHARACTERS = 2000
_SEVERITIES = {10: 'DEBUG', 20: 'INFO', 30: 'WARN', 40: 'ERROR', 50: 'FATAL'}


@dataclass(eq=False)
class Cell:
    """One execution of a notebook cell, as the destination of output.

    Attributes:
        parent: The kernel's request that runs the cell; empty outside a kernel.
        number: Which execution of the notebook it is, as in `In[12]`; 0 if that is not known.
        lines: Number of lines that callbacks have shown under it.
        box: The box of these lines, None if there are none or no page shows them.
        stream: The stream that they have written to last.
        held: Text held back until the cell waits (only without a person, see `Console`).
        ended: Whether a later cell was run.
    """

    parent: dict[str, Any] = field(default_factory=dict)
    number: int = 0
    lines: int = 0
    box: LogBox | None = None
    stream: TextIO | None = None
    held: list[tuple[TextIO, str]] = field(default_factory=list)
    ended: bool = False

    @property
    def request_id(self) -> str:
        """Return the unique id of this execution, '' outside a kernel."""
        return str(self.parent.get('header', {}).get('msg_id', ''))

    @property
    def cell_id(self) -> str:
        """Return the cell's id in the notebook, '' where the front end does not send it."""
        return str(self.parent.get('metadata', {}).get('cellId') or '')


@dataclass
class CallbackError:
    """An exception that callbacks raised, once or many times at the same place.

    Attributes:
        node_name: Full name of the node.
        callback: Name of the callback.
        error: The first exception.
        text: The learner's lines of the traceback, and the message.
        count: Number of times it was raised.
        cell: The execution that started the node.
    """

    node_name: str
    callback: str
    error: BaseException
    text: str
    count: int = 1
    cell: Cell | None = None


class Console:
    """Routes the output of callbacks.

    In a kernel without a person in front of it (nbval, `labkit record`) the output of callbacks
    appears under a cell exactly while the cell waits: it is held until a wait begins, and cut
    when the wait ends. So a cell's output depends on counts, not on time.
    """

    def __init__(self) -> None:
        self.errors: list[CallbackError] = []
        # Called at the end of a cell, while prints still belong to the cell.
        self.after_cell: Callable[[Cell], None] = lambda cell: None
        # Called with an exception that nobody has caught; the first returns how it ended a spin.
        self.last_words: Callable[[BaseException], str] = lambda error: ''
        self.uncaught: Callable[[BaseException], None] = lambda error: None
        # Called for each line of a log with its logger and its text, in the thread that logs.
        self.on_log: Callable[[str, str], None] = lambda name, message: None
        # Nodes started by one execution share its Cell, and so its limit of lines.
        self._running: Cell | None = None
        self._is_running = False
        self._cell: Cell | None = None
        self._thread = 0
        self._waiting = 0
        # When the running cell began, ns since 1970; 0 if that is not known.
        self.cell_began = 0
        # Number of lines counted instead of shown, see `holding`.
        self._held: list[int] | None = None
        self._streams: dict[str, _CellStream] = {}
        self._give_logs_back: Callable[[], None] | None = None

    def open(self) -> None:
        """Take over the streams and the ROS logs of a kernel. No effect elsewhere."""
        if not settings.in_kernel() or self._give_logs_back is not None:
            return
        self._take_streams()
        self._give_logs_back = compat.take_logs(self._show_log)
        settings.shell().events.register('pre_run_cell', self._end_cell)
        settings.shell().events.register('post_run_cell', self._finish_cell)
        self._is_running = True  # ROS is started by a cell
        tracebacks.install(settings.shell(), self.last_words, self.uncaught)

    def close(self) -> None:
        """Restore the streams and the ROS logs."""
        if self._give_logs_back is None:
            return
        for name, stream in self._streams.items():
            if getattr(sys, name) is stream:
                setattr(sys, name, stream.target)
        self._streams.clear()
        self._running = self._cell = None
        self._thread = 0
        self._give_logs_back()
        self._give_logs_back = None
        settings.shell().events.unregister('pre_run_cell', self._end_cell)
        settings.shell().events.unregister('post_run_cell', self._finish_cell)

    def _show_log(self, severity: int, name: str, message: str) -> None:
        self.on_log(name, message)
        print(f'[{_SEVERITIES.get(severity, severity)}] [{name}]: {message}')

    def _take_streams(self) -> bool:
        """Replace the kernel's streams by ours; return whether there were any to replace.

        Other streams stay. A cell that captures its output (`%%capture`) sets its own stream, and
        then restores the earlier one. So this is done repeatedly.
        """
        taken = False
        for name in ('stdout', 'stderr'):
            stream = getattr(sys, name)
            if compat.is_kernel_stream(stream):
                taken = True
                known = self._streams.get(name)
                if known is None or known.target is not stream:
                    known = self._streams[name] = _CellStream(self, stream)
                setattr(sys, name, known)
        return taken

    def current_cell(self) -> Cell:
        """Return the execution that the calling thread works for."""
        if not settings.in_kernel():
            return Cell()
        if self._cell is not None and self.speaks_in(threading.get_ident()):
            return self._cell
        if self._give_logs_back is None:
            # ROS does not run, so no event would tell that this cell has ended.
            return Cell(compat.running_request(), compat.running_number())
        if self._running is None:
            self._running = Cell(compat.running_request(), compat.running_number())
        return self._running

    @property
    def running_cell(self) -> Cell | None:
        """The execution that runs now, None between two, or if it has started nothing."""
        return self._running if self._is_running else None

    def speak_for(self, cell: Cell) -> None:
        """Show the calling thread's output under `cell` from now on."""
        again = self._give_logs_back is not None and self._take_streams()
        if cell is self._cell and not again:
            return
        self._cell = cell
        self._thread = threading.get_ident()
        if cell.parent:
            compat.set_thread_request(cell.parent)

    @contextmanager
    def waiting(self) -> Iterator[Callable[[], None]]:
        """Show the output of callbacks in a `with` block; yields a function that ends it early."""
        if threading.current_thread() is not threading.main_thread():
            yield lambda: None  # a thread that waits is not a cell that waits
            return
        open_now = [True]
        self._waiting += 1
        if self._running is not None:
            held, self._running.held = self._running.held, []
            for stream, text in held:
                self._write_bounded(self._running, stream, text)

        def end() -> None:
            if open_now:
                open_now.clear()
                self._waiting -= 1

        try:
            yield end
        finally:
            end()

    @contextmanager
    def holding(self) -> Iterator[list[int]]:
        """Hide the output of callbacks in a `with` block; yields a list with the line count."""
        self._held = lines = [0]
        try:
            yield lines
        finally:
            self._held = None

    def write(self, stream: TextIO, text: str) -> None:
        """Write output of a callback under the cell of its node."""
        if self._held is not None:
            self._held[0] += text.count('\n')
            return
        cell = self._cell
        if cell is None or not cell.parent:
            stream.write(text)
        elif settings.audience().same_each_time and not self._waiting:
            if not cell.ended:
                cell.held.append((stream, text))
        else:
            self._write_bounded(cell, stream, text)

    def write_under(self, cell: Cell, text: str) -> None:
        """Write output of another process under the cell that started it.

        Not when nobody watches: how much a process has printed depends on time.

        Args:
            cell: The execution that started the process.
            text: Whole lines. Each process has its own thread that calls this.
        """
        if self._held is not None:
            self._held[0] += text.count('\n')
            return
        if settings.audience().same_each_time:
            return
        if cell.parent and threading.current_thread() is not threading.main_thread():
            compat.set_thread_request(cell.parent)
        known = self._streams.get('stdout')
        self._write_bounded(cell, known.target if known is not None else sys.stdout, text)

    def speaks_in(self, thread_id: int) -> bool:
        """Return whether a thread is the one whose output is routed."""
        return thread_id == self._thread

    def show_error(self, node_name: str, callback: str, error: BaseException) -> None:
        """Show an exception of a callback: in full once per run of its cell, then as a count."""
        place = _place(error)
        cell = self._cell if self.speaks_in(threading.get_ident()) else self.current_cell()
        for known in self.errors:
            same = known.node_name == node_name and type(known.error) is type(error)
            if not (same and _place(known.error) == place):
                continue
            if known.cell is not cell:
                # The cell was run again, and Jupyter has cleared what it showed before.
                self.errors.remove(known)
                break
            known.count += 1
            if known.count in (10, 100, 1000, 10000):
                name = type(error).__name__
                text = f'{name} in {callback} of {node_name}: {known.count} times by now.\n'
                print(text, end='', file=sys.stderr)
            return
        if callback == 'destroy_node':
            words = f'destroy_node() of {node_name} failed. The node was ended all the same.'
        else:
            words = (
                f'The callback {callback} of {node_name} failed. The node goes on; '
                'if this happens again it is counted, not shown.'
            )
        seen = CallbackError(node_name, callback, error, short_traceback(error), cell=cell)
        self.errors.append(seen)
        print(f'{words}\n{seen.text}', file=sys.stderr)

    def _write_bounded(self, cell: Cell, stream: TextIO, text: str) -> None:
        progress_bar.note_output()
        if cell.parent and settings.audience().live:
            cell.box = cell.box or LogBox(cell.parent, MAX_LINES)
            cell.box.add(text)
        if stream is not cell.stream and cell.stream is not None:
            cell.stream.flush()  # or later text of another stream may overtake it
        cell.stream = stream
        if cell.lines >= MAX_LINES:
            return
        lines = text.splitlines(keepends=True)[: MAX_LINES - cell.lines]
        cell.lines += sum(line.endswith('\n') for line in lines)
        compat.write_for(cell.parent, stream, ''.join(map(_shortened, lines)))
        if cell.lines >= MAX_LINES:
            text = (
                f'{MAX_LINES} lines are shown; what follows is not. The node goes on. '
                'Run the cell again to see more, or end the node with lab.remove().\n'
            )
            compat.write_for(cell.parent, stream, text)

    def _end_cell(self, *_: object) -> None:
        """Close the previous cell: text it still holds belongs to no wait."""
        self.cell_began = time.time_ns()  # first: what comes after the last cell is of this one
        if self._running is not None:
            self._running.ended = True
            self._running.held.clear()
        self._running = None
        self._is_running = True

    def _finish_cell(self, *_: object) -> None:
        self._is_running = False
        self.after_cell(self.current_cell())


def _shortened(line: str) -> str:
    """Cut a long line, and append its length."""
    if len(line) <= MAX_CHARACTERS:
        return line
    end = '\n' * line.endswith('\n')
    return f'{line[:MAX_CHARACTERS]} ... ({len(line) - len(end):,} characters){end}'


class _CellStream(io.TextIOBase):
    """The kernel's stream, except that output of callbacks goes through the console."""

    def __init__(self, console: Console, target: TextIO) -> None:
        self.target = target
        self._console = console

    def write(self, text: str) -> int:
        if self._console.speaks_in(threading.get_ident()):
            self._console.write(self.target, text)
            return len(text)
        return self.target.write(text)

    def flush(self) -> None:
        self.target.flush()

    # Overrides where the base class has unsuitable defaults; `__getattr__` does the rest.

    @property
    def encoding(self) -> str:  # type: ignore[override]
        return self.target.encoding

    def writable(self) -> bool:
        return True

    def isatty(self) -> bool:
        return self.target.isatty()

    def fileno(self) -> int:
        return self.target.fileno()

    def __getattr__(self, name: str) -> Any:
        return getattr(self.target, name)


def _place(error: BaseException) -> list[tuple[str, int]]:
    found: list[tuple[str, int]] = []
    tb: TracebackType | None = error.__traceback__
    while tb is not None:
        found.append((tb.tb_frame.f_code.co_filename, tb.tb_lineno))
        tb = tb.tb_next
    return found
