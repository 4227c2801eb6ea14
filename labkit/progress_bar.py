"""A progress bar for what takes longer than a moment."""

from __future__ import annotations

import html
import time
from typing import Any

from labkit import settings

__all__ = ['ProgressBar']

SHOWN_AFTER_SEC = 1.0
EVERY_SEC = 0.2


class ProgressBar:
    """A progress bar under the running cell, removed when the work is done.

    Whether it appears depends on time, so only a learner in front of a notebook sees one.

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
        self._due = now + EVERY_SEC
        content = self._content(done, f'{self._label}: {words}')
        if self._handle is None:
            from IPython.display import display

            self._handle = display(content, raw=True, display_id=True)  # type: ignore[no-untyped-call]
        else:
            self._handle.update(content, raw=True)

    def close(self) -> None:
        """Remove the bar."""
        if self._handle is not None:
            self._handle.update({'text/plain': '', 'text/html': ''}, raw=True)
            self._handle = None

    def _content(self, done: float | None, text: str) -> dict[str, str]:
        value = '' if done is None else f' value="{min(max(done, 0.0), 1.0):.2f}"'
        words = html.escape(text)
        bar = f'<label>{words} <progress max="1"{value} style="width:20em"></progress></label>'
        return {'text/plain': text, 'text/html': bar}
