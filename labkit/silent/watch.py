"""Look for silent faults whenever something has changed, and show each once, under its cell.

A thread looks once a second. What it sees in two looks one after the other is there to stay, and
is shown; when it is mended, what was shown goes away. Where outputs are compared, it is shown as
the last output of the cell at whose end it is there, and stays.
"""

from __future__ import annotations

import atexit
import html
import threading
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from rclpy.exceptions import InvalidHandle

from labkit import settings
from labkit.asking.traffic import Sent, keep_counting
from labkit.background import compat
from labkit.background.console import Cell
from labkit.background.runtime import runtime
from labkit.silent.broadcasts import MOVING, STATIC, note_transforms
from labkit.silent.catalogue import AT_GRAPH, AT_NODES
from labkit.silent.kinds import Fault, in_words
from labkit.silent.matching_faults import DEPTH
from labkit.silent.message_faults import checks_of, frame_of, stamp_of
from labkit.silent.reading import Reader
from labkit.silent.scene import Scene
from labkit.silent.timing_faults import OVERRUN

if TYPE_CHECKING:
    from labkit.rosgraph.snapshot import Graph

__all__ = ['Watch', 'about', 'faults', 'seen_about', 'watch']

EVERY_SEC = 1.0
# What a queue did not hold, and how long a callback takes: a matter of how busy the machine is.
_BY_CHANCE = (DEPTH, OVERRUN)
_STYLE = (
    'border-left:0.4em solid var(--jp-warn-color1, #ef6c00);padding:0.3em 1em;margin:0.3em 0;'
    'max-width:60em;color:var(--jp-content-font-color1, inherit)'
)


class Watch:
    """The watch of this process: a singleton, `watch`.

    Attributes:
        error: The last error of a look in the background: a bug of labkit's own.
        seen: What the last look in the background has found, for views that ask often.
    """

    def __init__(self) -> None:
        self.error: Exception | None = None
        self._lock = threading.RLock()
        self._reader = Reader()
        self._looked_at: Graph | None = None
        self._at_graph: tuple[Fault, ...] = ()
        self.seen: tuple[Fault, ...] = ()
        self._last: frozenset[Fault] = frozenset()
        self._notes: WeakKeyDictionary[Cell, _Note] = WeakKeyDictionary()
        self._resting = 0
        self._thread: threading.Thread | None = None
        self._end = threading.Event()

    def start(self) -> None:
        """Begin to look, until ROS is stopped."""
        if self._thread is not None and self._thread.is_alive():
            return
        keep_counting(_look_into)
        self._reader.forget()
        self._last = frozenset()
        if settings.audience().same_each_time:
            events = settings.shell().events
            with suppress(ValueError):  # it is to come after the console, each time ROS is started
                events.unregister('post_run_cell', self._record)
            events.register('post_run_cell', self._record)
            return
        self._end.clear()
        self._thread = threading.Thread(target=self._run, name='labkit watch', daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the thread, before the interpreter does."""
        self._end.set()
        if self._thread is not None:
            self._thread.join()

    def look(self) -> tuple[Fault, ...]:
        """Return the faults that are there now."""
        with self._lock:
            return self._all(self._reader.read())

    @contextmanager
    def resting(self) -> Iterator[None]:
        """Look at nothing in a `with` block, in which a check lets time pass as it likes."""
        with self._lock:
            self._resting += 1
        try:
            yield
        finally:
            with self._lock:
                self._resting -= 1
                self._reader.forget()
                for entry in runtime.nodes() if runtime.started else ():
                    entry.took.clear()

    @property
    def is_resting(self) -> bool:
        """Whether a check lets time pass."""
        return self._resting > 0

    def _record(self, _result: object) -> None:
        """Show what is there to stay at the end of a cell, and was not at the end of the last."""
        if not runtime.started:
            return
        with suppress(InvalidHandle):  # a callback has ended its node; the next cell's end sees it
            self._show_new()

    def _show_new(self) -> None:
        own = {entry.name for entry in runtime.nodes()}
        found = [
            fault
            for fault in self.look()
            # What nodes of other processes have between them is no matter of a cell.
            if fault.is_aloud and (fault.cell is not None or own.intersection(fault.nodes))
            if fault.kind not in _BY_CHANCE
        ]
        if any(fault not in self._last for fault in found):
            time.sleep(EVERY_SEC)
            now = self.look()
            found = [fault for fault in now if fault in found]
        new = [fault for fault in found if fault not in self._last]
        self._last = frozenset(found)
        if new:
            _Note(Cell(compat.running_request())).show(new)

    def _all(self, scene: Scene) -> tuple[Fault, ...]:
        if scene.graph is not self._looked_at:
            self._at_graph = tuple(found for look in AT_GRAPH for found in look(scene))
            self._looked_at = scene.graph
        near = (found for look in AT_NODES for found in look(scene))
        return tuple(dict.fromkeys((*self._at_graph, *near)))

    # -- the thread -----------------------------------------------------------------------------

    def _run(self) -> None:
        while not self._end.wait(EVERY_SEC):
            if not runtime.started:
                self._show({})
                break
            try:
                self._step()
            except Exception as error:  # nodes end meanwhile; the next look sees the rest
                if runtime.started and not isinstance(error, InvalidHandle):
                    self.error = error

    def _step(self) -> None:
        with self._lock:
            if self._resting:
                return
            scene = self._reader.read()
            found = self._all(scene)
            now = frozenset(found)
            aloud = [fault for fault in found if fault in self._last and fault.is_aloud]
            self._last, self.seen = now, found
        cells: dict[Cell, list[Fault]] = {}
        for fault in aloud:
            owner = next((node for name in fault.nodes if (node := scene.own(name))), None)
            cell = fault.cell or (owner.cell if owner is not None else None)
            if cell is not None:
                cells.setdefault(cell, []).append(fault)
        self._show(cells)

    def _show(self, cells: dict[Cell, list[Fault]]) -> None:
        for cell, note in list(self._notes.items()):
            if cell not in cells:
                note.show([])
        for cell, some in cells.items():
            if cell.parent:
                note = self._notes.get(cell) or _Note(cell)
                self._notes[cell] = note
                note.show(some)


class _Note:
    """The faults of one cell, as an output under it."""

    def __init__(self, cell: Cell) -> None:
        self._parent = cell.parent
        self._display_id = f'labkit-fault-{uuid.uuid4().hex}'
        self._shown: list[Fault] | None = None

    def show(self, faults: list[Fault]) -> None:
        if faults == self._shown:
            return
        text = in_words(faults)
        page = '<br>'.join(map(html.escape, text.splitlines()))
        data = {
            'text/plain': text,
            'text/html': f'<div style="{_STYLE}">{page}</div>' * bool(text),
        }
        update = self._shown is not None
        self._shown = faults
        compat.display_under(self._parent, data, self._display_id, update=update)


def _look_into(publisher: Any, message: Any, sent: Sent) -> None:
    """Look into a message that was published: a few fields, for types that are known."""
    if isinstance(message, bytes):
        return
    # What a check sends, and what answers it, is drawn: its numbers are no fault of anybody.
    looks = not watch.is_resting
    try:
        if publisher.msg_type.__name__ == 'TFMessage':
            if publisher.topic_name in (MOVING, STATIC):
                note_transforms(sent, message.transforms, publisher.topic_name, looks=looks)
            return
        if not looks:
            return
        take = stamp_of(publisher.msg_type)
        sent.stamp = take(message) if take is not None else None
        sent.frame = frame_of(message)
        sent.found = {
            kind.id: words
            for check in checks_of(publisher.msg_type)
            for kind, words in check(message)
        }
    except Exception:  # a field has something else than its type says; publishing goes on
        sent.found = {}


watch = Watch()
atexit.register(watch.close)


def faults() -> tuple[Fault, ...]:
    """Return the silent faults that are there now.

    None where outputs are compared: some come only with time, or from another process.
    """
    if not runtime.started or settings.audience().same_each_time:
        return ()
    return watch.look()


def about(name: str) -> list[Fault]:
    """Return the faults of a node, or about a topic, by its full name."""
    return [fault for fault in faults() if name in fault.names]


def seen_about(name: str) -> list[Fault]:
    """Return what the last look in the background found about a node or a topic."""
    return [fault for fault in watch.seen if name in fault.names]
