"""A progress bar for what takes longer than a moment."""

from __future__ import annotations

import html
import time
from typing import Any

from labkit import settings

__all__ = ['ProgressBar', 'note_output']

SHOWN_AFTER_SEC = 1.0
EVERY_SEC = 0.2

# When a cell has shown something last, and the bar that is shown: there is one at a time.
_last_output = 0.0
_shown: ProgressBar | None = None


def note_output() -> None:
    """Note that something has appeared under a cell: what speaks needs no bar yet."""
    global _last_output
    _last_output = time.monotonic()


class ProgressBar:
    """A progress bar under the running cell, removed when the work is done.

    It appears where nothing else has for a second, and none appears beside one that is shown. That
    depends on time, so only a learner in front of a notebook sees one.

    Args:
        label: The activity, such as `'Checking'`.
    """

    def __init__(self, label: str) -> None:
        self._label = label
        self._due = time.monotonic() + SHOWN_AFTER_SEC
        self._handle: Any = None
        self._wanted = settings.audience() is settings.LEARNER

    def show(self, done: float | None, words: str) -> None:
        """Show the progress, at most every `EVERY_SEC`.

        Args:
            done: The fraction that is done, None if unknown.
            words: The progress in words.
        """
        now = time.monotonic()
        if not self._wanted or now < self._due:
            return
        global _shown
        if _shown is not self and (_shown or now < _last_output + SHOWN_AFTER_SEC):
            return
        self._due = now + EVERY_SEC
        content = self._content(done, f'{self._label}: {words}')
        if self._handle is None:
            from IPython.display import DisplayHandle

            # The stop button may be pressed as soon as it is seen, and `close` must know it then.
            self._handle = DisplayHandle()  # type: ignore[no-untyped-call]
            _shown = self
            self._handle.display(content, raw=True)
        else:
            self._handle.update(content, raw=True)

    def close(self) -> None:
        """Remove the bar."""
        global _shown
        if self._handle is not None:
            _shown = None
            self._handle.update({'text/plain': '', 'text/html': ''}, raw=True)
            self._handle = None

    def _content(self, done: float | None, text: str) -> dict[str, str]:
        value = '' if done is None else f' value="{min(max(done, 0.0), 1.0):.2f}"'
        words = html.escape(text)
        bar = f'<label>{words} <progress max="1"{value} style="width:20em"></progress></label>'
        return {'text/plain': text, 'text/html': bar}
