"""Live views with a part in the page: who looks on, and when the page gets news.

A view listens only while a page shows it. The page says so again and again, so that one that is
gone for whatever reason (cleared, closed, crashed) leaves no subscription behind. And the page
hears something again and again, so that it can tell a silent topic from a kernel that is gone.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from labkit.background.compat import call_in_kernel
from labkit.views.feed import Feed
from labkit.views.live import Live, helper
from labkit.views.stored import Stored
from labkit.views.widget import PageWidget, widget_class

__all__ = ['LivePage', 'News']

# What goes to the page: words and numbers, and bytes.
News = tuple[dict[str, Any], list[bytes]]

# Who publishes is looked at this often, s, and at once when somebody has come or gone.
LOOK_SEC = 0.5
# The page hears something at least this often, s, so that it knows that all is well.
STATUS_SEC = 1.0
# So often, s, what the notebook stores of a view is brought up to date.
KEEP_SEC = 5.0
# A page speaks up every 2 s. One that has not for so long is gone, s.
GONE_SEC = 10.0
# What a page has said while a cell was running is heard so long after its end, s.
CATCH_UP_SEC = 1.0


class LivePage(Live):
    """A live view with a part in the page, where a person looks at one; else it is a still.

    Args:
        feeds: The topics that it listens to.
    """

    # The page hears something new this long after the last news at the earliest, s.
    _least: ClassVar[float] = 0.0

    def __init__(self, feeds: Sequence[Feed] = ()) -> None:
        super().__init__()
        self._feeds = list(feeds)
        self._seen_at = self._looked_at = self._sent_at = self._kept_at = 0.0
        # What the page has been told.
        self._told: dict[str, Any] = {}
        self._widget: PageWidget | None = None
        self._stored: Stored | None = None
        if self._watched:
            self._widget = widget_class(self._name)()
            self._stored = Stored(self._widget)
            self._widget.on_msg(self._on_message)
            self._take_place()

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        return self._still()

    def _ipython_display_(self) -> None:
        if self._stored is None:
            raise NotImplementedError  # then IPython asks for the bundle
        self._stored.show(self._still())

    # -- for those that are made on it ----------------------------------------------------------

    def _still(self) -> dict[str, str]:
        """Return what is shown where nothing can be live: a text, and maybe a picture."""
        raise NotImplementedError

    def _stored_form(self) -> dict[str, str]:
        """Return what is stored: the same of what is known, at once."""
        return self._still()

    def _news(self, everything: bool) -> News:
        """Return what the page does not know yet, or all there is to know."""
        raise NotImplementedError

    def _new_of(self, state: Mapping[str, Any]) -> dict[str, Any]:
        """Return that part of what is true which the page has not been told."""
        new = {key: value for key, value in state.items() if value != self._told.get(key)}
        self._told.update(state)
        return new

    def _hear(self, content: dict[str, Any]) -> None:
        """Take what the page says besides that it is there."""

    # -- listening ------------------------------------------------------------------------------

    def _open(self) -> None:
        with self._lock:
            super()._open()
            self._seen_at = self._looked_at = time.monotonic()
            for feed in self._feeds:
                feed.open(helper())

    def _close(self) -> None:
        with self._lock:
            for feed in self._feeds:
                feed.close()
            super()._close()
            self._keep()

    def _tick(self) -> None:
        now = time.monotonic()
        if now - self._seen_at > GONE_SEC:
            self._seen_at = now
            self._ask_whether_gone(now)
        due = now - self._looked_at >= LOOK_SEC
        for feed in self._feeds:
            if due or not feed.is_settled:
                feed.look()
        if due:
            self._looked_at = now
        if now - self._kept_at >= KEEP_SEC:
            self._keep()
        self._send()

    def _on_destroyed(self) -> None:
        super()._on_destroyed()
        with self._lock:
            if self._node is not None:
                for feed in self._feeds:
                    feed.look()

    def _keep(self) -> None:
        """Store what is known in the notebook."""
        self._kept_at = time.monotonic()
        if self._stored is not None:
            self._stored.keep(self._stored_form())

    # -- the page -------------------------------------------------------------------------------

    def _on_message(self, _: object, content: dict[str, Any], __: object) -> None:
        """The page says that somebody sees the view, still does, or that nobody does any more."""
        with self._lock:
            words = self._ended or self._cut_off()
            if not words:
                self._obey(content)
            elif content.get('view') == 'seen':
                # What it showed last, to a page that is loaded again.
                self._ended = words
                self._send(everything=True)
        if words:
            self._end(words)

    def _obey(self, content: dict[str, Any]) -> None:
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
            self._hear(content)

    def _ask_whether_gone(self, asked_at: float) -> None:
        """Close unless the page speaks up, as soon as the kernel can hear it.

        Where a running cell keeps the kernel from hearing pages, it keeps this waiting too.
        """

        def close() -> None:
            with self._lock:
                if self._seen_at == asked_at:
                    self._close()

        call_in_kernel(close, delay_sec=CATCH_UP_SEC)

    def _send(self, *, everything: bool = False) -> None:
        since = time.monotonic() - self._sent_at
        if everything:
            self._told.clear()
        elif since < self._least:
            return  # a timer that was late ticks again soon
        content, buffers = self._news(everything)
        if everything:
            content['all'] = True
        if content or buffers or since >= STATUS_SEC:
            self._tell(content, buffers)
            self._sent_at = time.monotonic()

    def _say_end(self) -> None:
        self._tell({'ended': self._ended})

    def _tell(self, content: dict[str, Any], buffers: Sequence[bytes] = ()) -> None:
        if self._widget is not None:
            self._widget.send(content, list(buffers) or None)
