"""A class, live, for the projector or for the teacher alone.

The page gets words and numbers and puts them in as text. What is stored in the notebook has no
names in it, so that a teacher can hand it on.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from labkit import settings
from labkit.views.class_board import Board, text_form
from labkit.views.live import helper
from labkit.views.live_page import LivePage, News

__all__ = ['Classroom']

# So often it is looked at what learners have sent, s.
LOOK_SEC = 2.0
# A folder that has not answered for so long may be one of a network that is gone, s.
SILENT_SEC = 20.0
SILENT = 'The folder of the class does not answer. This is how it was before.'


class Classroom(LivePage):
    """A live view of a class, to be shown in a cell; see `labkit.teaching.classroom`.

    Args:
        look: Returns what is true of the class now.
        names: Whether to tell who is who.
    """

    _name = 'classroom'
    _period = 0.5

    def __init__(self, look: Callable[[], Board], *, names: bool) -> None:
        self._look, self._names = look, names
        self._board, self._answered_at = look(), time.monotonic()
        self._looking: _Looking | None = None
        if settings.audience().live:
            helper()  # which the page's side of a view lives with
        super().__init__()

    def __repr__(self) -> str:
        return text_form(self._look(), names=self._names)

    def _still(self) -> dict[str, str]:
        # A program may have names in its output, if it asks for them; a notebook is handed on.
        return {'text/plain': text_form(self._board, names=self._names and not self._watched)}

    def _open(self) -> None:
        with self._lock:
            super()._open()
            self._looking = _Looking(self._look, self._take)
            self._looking.start()

    def _close(self) -> None:
        with self._lock:
            if self._looking is not None:
                self._looking.end()
                self._looking = None
            super()._close()

    def _take(self, board: Board) -> None:
        self._board, self._answered_at = board, time.monotonic()

    def _news(self, everything: bool) -> News:
        board = self._board
        silent = time.monotonic() - self._answered_at > SILENT_SEC
        state: dict[str, Any] = {
            'figures': [board.shared, board.at_work, board.stuck],
            'lessons': [[row.title, row.here, list(row.exercises)] for row in board.lessons],
            'fails': [[row.count, row.exercise, row.sentence] for row in board.fails],
            'learners': self._learners(board),
            'note': SILENT if silent else board.note,
            'told': board.told,
        }
        return self._new_of(state), []

    def _learners(self, board: Board) -> list[list[Any]] | None:
        """Return a row a learner; None if nobody is to be named."""
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
                row.remark,
            ]
            for row in board.learners
        ]


class _Looking(threading.Thread):
    """Looks again and again, in a thread of its own: ROS does not wait for a slow folder."""

    def __init__(self, look: Callable[[], Board], take: Callable[[Board], None]) -> None:
        super().__init__(name='labkit classroom', daemon=True)
        self._look, self._take = look, take
        self._ending = threading.Event()

    def end(self) -> None:
        """Look no more. A look that is on its way is not waited for."""
        self._ending.set()

    def run(self) -> None:
        """Look until the end."""
        while not self._ending.is_set():
            board = self._look()
            if not self._ending.is_set():
                self._take(board)
            self._ending.wait(LOOK_SEC)
