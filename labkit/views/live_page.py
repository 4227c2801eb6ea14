"""Live views in a page: whether anybody is looking, and when the page gets updates.

A view listens only while a page shows it. The page reports that periodically, so that a page that
is gone for any reason (cleared, closed, crashed) leaves no subscription behind. The page also gets
something periodically, so that it can tell a silent topic from a dead kernel.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from labkit.background.compat import call_in_kernel
from labkit.views.feed import Feed
from labkit.views.live import Live, helper
from labkit.views.stored_form import Stored
from labkit.views.widget import PageWidget, widget_class

__all__ = ['LivePage', 'Update']

# An update for the page: state and binary buffers.
Update = tuple[dict[str, Any], list[bytes]]

# Period of looking for publishers, s; sooner when one has appeared or gone.
REFRESH_SEC = 0.5
# The page gets an update at least this often, s, as a sign of life.
STATUS_SEC = 1.0
# Period of updating the stored form in the notebook, s.
STORE_SEC = 5.0
# A page reports every 2 s. Without a report for this long it is gone, s.
GONE_SEC = 10.0
# The kernel handles messages that came during a cell within this time after it, s.
CATCH_UP_SEC = 1.0


class LivePage(Live):
    """A live view in a page, where a person looks at one; otherwise a still.

    Args:
        feeds: The topics that it subscribes to.
    """

    # Least time between two updates, s.
    _min_interval: ClassVar[float] = 0.0

    def __init__(self, feeds: Sequence[Feed] = ()) -> None:
        super().__init__()
        self._feeds = list(feeds)
        self._seen_at = self._refreshed_at = self._sent_at = self._stored_at = 0.0
        # The state that the page has received.
        self._page_state: dict[str, Any] = {}
        self._widget: PageWidget | None = None
        self._stored: Stored | None = None
        if self._watched:
            self._widget = widget_class(self._name)()
            self._stored = Stored(self._widget, self._called)
            self._widget.on_msg(self._on_message)
            self._start()

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        return self._static()

    def _ipython_display_(self) -> None:
        if self._stored is None:
            raise NotImplementedError  # IPython then asks for the bundle
        self._stored.show(self._static())

    # -- for subclasses -------------------------------------------------------------------------

    def _static(self) -> dict[str, str]:
        """Return the static form: text, and maybe a picture."""
        raise NotImplementedError

    def _stored_form(self) -> dict[str, str]:
        """Return the form to store now, without waiting for messages."""
        return self._static()

    def _update(self, everything: bool) -> Update:
        """Return the changes that the page has not received yet, or everything."""
        raise NotImplementedError

    def _changes(self, state: Mapping[str, Any]) -> dict[str, Any]:
        """Return the part of a state that the page has not received, and mark it as received."""
        new = {key: value for key, value in state.items() if value != self._page_state.get(key)}
        self._page_state.update(state)
        return new

    def _handle_request(self, content: dict[str, Any]) -> None:
        """Handle a message of the page other than its reports."""

    # -- listening ------------------------------------------------------------------------------

    def _open(self) -> None:
        with self._lock:
            super()._open()
            self._seen_at = self._refreshed_at = time.monotonic()
            for feed in self._feeds:
                feed.open(helper())

    def _open_early(self) -> None:
        """Listen before the page asks: it can't while this cell, or one after it, is running."""
        if self._watched and not self._ended and self._node is None:
            self._open()

    def _close(self) -> None:
        with self._lock:
            for feed in self._feeds:
                feed.close()
            super()._close()
            self._store()

    def _tick(self) -> None:
        now = time.monotonic()
        if now - self._seen_at > GONE_SEC:
            self._seen_at = now
            self._ask_whether_gone(now)
        due = now - self._refreshed_at >= REFRESH_SEC
        for feed in self._feeds:
            if due or not feed.is_settled:
                feed.refresh()
        if due:
            self._refreshed_at = now
        if now - self._stored_at >= STORE_SEC:
            self._store()
        self._send()

    def _on_destroyed(self) -> None:
        super()._on_destroyed()
        with self._lock:
            if self._node is not None:
                for feed in self._feeds:
                    feed.refresh()

    def _store(self) -> None:
        """Store the current form in the notebook."""
        self._stored_at = time.monotonic()
        if self._stored is not None:
            self._stored.update(self._stored_form())

    # -- the page -------------------------------------------------------------------------------

    def _on_message(self, _: object, content: dict[str, Any], __: object) -> None:
        """Handle a report that the view became visible, still is, or is gone."""
        with self._lock:
            words = self._ended or self._why_stopped()
            if not words:
                self._handle_report(content)
            elif content.get('view') == 'seen':
                # A page that was reloaded gets the last picture.
                self._ended = words
                self._send(everything=True)
        if words:
            self._end(words)

    def _handle_report(self, content: dict[str, Any]) -> None:
        view = content.get('view')
        if view == 'gone':
            self._close()
            return
        opened = self._node is None
        if opened:
            self._open()
        self._seen_at = time.monotonic()
        if opened or view == 'seen':
            self._send(everything=True)
        if view is None:
            self._handle_request(content)

    def _ask_whether_gone(self, asked_at: float) -> None:
        """Close unless the page reports once the kernel can hear it: a cell may keep it busy."""

        def close() -> None:
            with self._lock:
                if self._seen_at == asked_at:
                    self._close()

        call_in_kernel(close, delay_sec=CATCH_UP_SEC)

    def _send(self, *, everything: bool = False) -> None:
        since = time.monotonic() - self._sent_at
        if everything:
            self._page_state.clear()
        elif since < self._min_interval:
            return  # the next tick will send it
        content, buffers = self._update(everything)
        if everything:
            content['all'] = True
        if content or buffers or since >= STATUS_SEC:
            self._send_to_page(content, buffers)
            self._sent_at = time.monotonic()

    def _show_end(self) -> None:
        self._send_to_page({'ended': self._ended})

    def _send_to_page(self, content: dict[str, Any], buffers: Sequence[bytes] = ()) -> None:
        if self._widget is not None:
            self._widget.send(content, list(buffers) or None)
