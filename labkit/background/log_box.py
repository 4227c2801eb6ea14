"""A scrolling box for the output of a cell's nodes, with a count of lines.

The lines remain in the cell's stream, so they can be copied, are coloured, and stay in order with
what else the cell prints. A separate output before them has the style that makes the box, and the
count.
"""

from __future__ import annotations

import functools
import html
import time
import uuid
from pathlib import Path
from typing import Any

from labkit.background import compat

__all__ = ['LogBox']

# The count is shown if there are more lines than this.
LINES = 12
EVERY_SEC = 0.5


class LogBox:
    """The box for all output under one cell from now on.

    Args:
        request: The kernel's request that runs the cell.
        kept: Number of lines to keep; of later ones only the last is shown.
    """

    def __init__(self, request: dict[str, Any], kept: int) -> None:
        self._request, self._kept = request, kept
        self._display_id = f'labkit-log-{uuid.uuid4().hex}'
        self._count, self._last = 0, ''
        self._due, self._is_scheduled = 0.0, False
        self._show(update=False)

    def add(self, text: str) -> None:
        """Count the lines of a text."""
        self._count += text.count('\n')
        self._last = ([line for line in text.splitlines() if line] or [self._last])[-1]
        if self._count <= LINES:
            return
        if time.monotonic() >= self._due:
            self._update()
        elif not self._is_scheduled:
            # There may be no further line to show the last count with.
            self._is_scheduled = True
            compat.call_in_kernel(self._update, delay_sec=EVERY_SEC)

    def _update(self) -> None:
        self._due, self._is_scheduled = time.monotonic() + EVERY_SEC, False
        self._show(update=True)

    def _show(self, *, update: bool) -> None:
        words = ''
        if self._count > LINES:
            words = f'{self._count:,} lines'
        if self._count > self._kept:
            words += f', the first {self._kept} below. The last one: {self._last[:200]}'
        style = f'<style class="labkit-style">{_rules()}</style>'
        page = f'{style}<div class="labkit-log">{html.escape(words)}</div>'
        compat.display_under(self._request, {'text/html': page}, self._display_id, update=update)


@functools.lru_cache(maxsize=1)
def _rules() -> str:
    return Path(__file__).with_suffix('.css').read_text(encoding='utf-8')
