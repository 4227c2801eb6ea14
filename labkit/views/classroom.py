"""A live view of a class, for the projector or for the teacher alone.

The stored output has no names in it, so that a teacher can share the notebook.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from labkit import settings
from labkit.views.class_board import Board, text_form
from labkit.views.live import helper
from labkit.views.live_page import LivePage, Update

__all__ = ['Classroom']

# Period of reading the folder of the class, s.
READ_SEC = 2.0
# A folder that has not answered for this long may be on a disconnected network drive, s.
SILENT_SEC = 20.0
SILENT = 'The folder of the class does not answer. This is how it was before.'


class Classroom(LivePage):
    """A live view of a class, to be shown in a cell; see `labkit.teaching.classroom`.

    Args:
        read: Returns the current state of the class.
        names: Whether to show names.
    """

    _name = 'classroom'
    _period = 0.5

    def __init__(self, read: Callable[[], Board], *, names: bool) -> None:
        self._read, self._names = read, names
        self._board, self._answered_at = read(), time.monotonic()
        self._reader: _Reader | None = None
        if settings.audience().live:
            helper()  # the view's page needs it
        super().__init__()

    def __repr__(self) -> str:
        return text_form(self._read(), names=self._names)

    def _static(self) -> dict[str, str]:
        # A program may print names if asked to; a notebook gets shared.
        return {'text/plain': text_form(self._board, names=self._names and not self._watched)}

    def _open(self) -> None:
        with self._lock:
            super()._open()
            self._reader = _Reader(self._read, self._on_board)
            self._reader.start()

    def _close(self) -> None:
        with self._lock:
            if self._reader is not None:
                self._reader.stop()
                self._reader = None
            super()._close()

    def _on_board(self, board: Board) -> None:
        self._board, self._answered_at = board, time.monotonic()

    def _update(self, everything: bool) -> Update:
        board = self._board
        silent = time.monotonic() - self._answered_at > SILENT_SEC
        state: dict[str, Any] = {
            'figures': [board.shared, board.at_work, board.stuck],
            'lessons': [[row.title, row.here, list(row.exercises)] for row in board.lessons],
            'fails': [[row.count, row.exercise, row.sentence] for row in board.fails],
            'guesses': [
                [row.title, row.ask, list(row.options), row.came] for row in board.guesses
            ],
            'learners': self._learners(board),
            'note': SILENT if silent else board.note,
            'told': board.told,
        }
        return self._changes(state), []

    def _learners(self, board: Board) -> list[list[Any]] | None:
        """Return one row per learner; None without names."""
        if not self._names:
            return None
        return [
            [
                row.name,
                row.lesson,
                '' if row.quiet_min is None else f'{row.done} of {board.exercise_count}',
                row.exercise,
                row.last,
                row.stuck_min,
                row.quiet_min,
                row.since_min,
                list(row.marks),
                row.remark,
            ]
            for row in board.learners
        ]


class _Reader(threading.Thread):
    """Reads the class periodically, in its own thread: ROS must not wait for a slow folder."""

    def __init__(self, read: Callable[[], Board], callback: Callable[[Board], None]) -> None:
        super().__init__(name='labkit classroom', daemon=True)
        self._read, self._on_board = read, callback
        self._stopping = threading.Event()

    def stop(self) -> None:
        """Stop reading, without waiting for a read in progress."""
        self._stopping.set()

    def run(self) -> None:
        """Read until stopped."""
        while not self._stopping.is_set():
            board = self._read()
            if not self._stopping.is_set():
                self._on_board(board)
            self._stopping.wait(READ_SEC)
