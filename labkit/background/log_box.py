"""A box for what nodes of a cell say: it shows the last lines, scrolls inside, and counts them.

The lines are those of the cell's stream, as without it, so that they can be copied, are coloured,
and stay in order with what else the cell prints. What makes the box is a style, which comes in an
output of its own before them; the count is in that output too.
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

# Fewer lines need no count.
LINES = 12
# The count is brought up to date so often, s.
EVERY_SEC = 0.5


class LogBox:
    """The box under one cell. What is written under the cell from now on is in it.

    Args:
        request: The kernel's request that runs the cell.
        kept: So many lines are kept; of those that follow only the last one is shown.
    """

    def __init__(self, request: dict[str, Any], kept: int) -> None:
        self._request, self._kept = request, kept
        self._name = f'labkit-log-{uuid.uuid4().hex}'
        self._count, self._last = 0, ''
        self._due, self._waits = 0.0, False
        self._show(update=False)

    def add(self, text: str) -> None:
        """Count the lines of a text."""
        self._count += text.count('\n')
        self._last = ([line for line in text.splitlines() if line] or [self._last])[-1]
        if self._count <= LINES:
            return
        if time.monotonic() >= self._due:
            self._tell()
        elif not self._waits:
            # Nothing more may come, and the last count is the one that stays.
            self._waits = True
            compat.call_in_kernel(self._tell, delay_sec=EVERY_SEC)

    def _tell(self) -> None:
        self._due, self._waits = time.monotonic() + EVERY_SEC, False
        self._show(update=True)

    def _show(self, *, update: bool) -> None:
        words = ''
        if self._count > LINES:
            words = f'{self._count:,} lines'
        if self._count > self._kept:
            words += f', the first {self._kept} below. The last one: {self._last[:200]}'
        style = f'<style class="labkit-style">{_rules()}</style>'
        page = f'{style}<div class="labkit-log">{html.escape(words)}</div>'
        compat.display_under(self._request, {'text/html': page}, self._name, update=update)


@functools.lru_cache(maxsize=1)
def _rules() -> str:
    return Path(__file__).with_suffix('.css').read_text(encoding='utf-8')
