"""What live views share: who looks on, when the page gets news, and when all of it ends.

A live view listens only while a page shows it. The page says so again and again, so that one that
is gone for whatever reason (cleared, closed, crashed) leaves no subscription behind.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import anywidget

from labkit import settings
from labkit.background.discovery import alone, asking_node
from labkit.background.nodes import after_destroy, node_exists
from labkit.background.runtime import runtime
from labkit.views.feed import Feed

__all__ = ['Live', 'heard', 'is_live', 'page_widget', 'replace_earlier']

# The page gets news every so often at most, s. It makes sure of no more than 20 in any second.
UPDATE_SEC = 0.055
# Who publishes is looked at this often, s, and at once when somebody has come or gone.
LOOK_SEC = 0.5
# The page hears something at least this often, s, so that it knows that all is well.
STATUS_SEC = 1.0
# A page speaks up every 2 s. One that has not for so long is gone, s.
GONE_SEC = 10.0
# What a page has said while a cell was running is heard so long after its end, s.
CATCH_UP_SEC = 1.0
# How long a still picture waits for messages, s, and for somebody to publish any: in this process,
# or in another one, which may have been started just now.
STILL_SEC = 4.0
NOBODY_SEC = 1.0
NOBODY_ELSEWHERE_SEC = 3.0


def is_live() -> bool:
    """Tell whether somebody may look at a page: there is a kernel, and a person before it."""
    return settings.audience().live


def page_widget(name: str) -> type[anywidget.AnyWidget]:
    """Return the class of a view's part in the page.

    Args:
        name: Its files are `NAME.js` and `NAME.css`; what all live views share goes before.
    """
    folder = Path(__file__).parent
    files = {
        attribute: '\n'.join(
            (folder / f'{part}.{ending}').read_text(encoding='utf-8') for part in ('live', name)
        )
        for attribute, ending in (('_esm', 'js'), ('_css', 'css'))
    }
    return type(f'_{name.capitalize()}Page', (anywidget.AnyWidget,), files)


def replace_earlier(live: dict[Any, tuple[str, str]], new: Any) -> None:
    """End the views that an earlier run of this cell has made.

    Args:
        live: The views that live, each with the cell and its execution that made it.
        new: The view that is made now.
    """
    cell = runtime.console.current_cell()
    for other, (cell_id, request_id) in list(live.items()):
        if cell.cell_id and cell_id == cell.cell_id and request_id != cell.request_id:
            other.close()
    live[new] = (cell.cell_id, cell.request_id)


@contextmanager
def heard(feeds: Sequence[Feed], enough: Callable[[], object]) -> Iterator[None]:
    """Wait for messages of topics; they stay open for as long as a `with` block lasts.

    Args:
        feeds: The topics.
        enough: Tells whether there are enough messages. Waiting ends too when time is over, or
            when nobody publishes one of the topics.
    """
    node = asking_node()
    begin, patience = time.monotonic(), NOBODY_SEC if alone() else NOBODY_ELSEWHERE_SEC

    def done() -> bool:
        for feed in feeds:
            if not feed.is_settled:
                feed.look()
        late = time.monotonic() - begin > patience
        settled = all(feed.is_settled for feed in feeds)
        return bool(settled and enough()) or (
            late and not all(feed.is_promising for feed in feeds)
        )

    for feed in feeds:
        feed.open(node)
    try:
        runtime.wait(done, STILL_SEC)
        yield
    finally:
        for feed in feeds:
            feed.close()


class Live:
    """A view of topics. What it shows is up to those that are made on it.

    Args:
        widget: The class of its part in the page.
        feeds: The topics that it listens to.
    """

    _what = 'view'

    def __init__(self, widget: type[anywidget.AnyWidget], feeds: Sequence[Feed]) -> None:
        self._feeds = list(feeds)
        self._lock = threading.RLock()
        self._node: Any = None
        self._timer: Any = None
        self._seen_at = self._looked_at = self._sent_at = 0.0
        self._widget: Any = None
        if is_live():
            self._widget = widget()
            self._widget.on_msg(self._on_message)
            replace_earlier(_live, self)

    # -- for cells ------------------------------------------------------------------------------

    def close(self) -> None:
        """Listen no more. What is shown stays as it is."""
        self._end(f'This {self._what} has ended. Run its cell to start a new one.')

    def __enter__(self) -> Live:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _page_bundle(self) -> dict[str, Any]:
        shown: Any = self._widget._repr_mimebundle_()
        return dict(shown[0] if isinstance(shown, tuple) else shown or {})

    # -- what to say, for those that are made on it ---------------------------------------------

    def _news(self, everything: bool) -> tuple[dict[str, Any], list[bytes]]:
        """Return what the page does not know yet, or all there is to know."""
        raise NotImplementedError

    # -- listening ------------------------------------------------------------------------------

    def _open(self) -> None:
        with self._lock:
            self._node = runtime.helper
            for feed in self._feeds:
                feed.open(self._node)
            self._looked_at = time.monotonic()
            self._timer = self._node.create_timer(UPDATE_SEC, self._on_timer)

    def _close(self) -> None:
        with self._lock:
            for feed in self._feeds:
                feed.close()
            if self._node is not None and node_exists(self._node):
                self._node.destroy_timer(self._timer)
            self._node = self._timer = None

    def _look(self) -> None:
        with self._lock:
            if self._node is not None:
                for feed in self._feeds:
                    feed.look()

    # -- the page -------------------------------------------------------------------------------

    def _on_message(self, _: object, content: dict[str, Any], __: object) -> None:
        """The page says that somebody sees the view, still does, or that nobody does any more."""
        with self._lock:
            if content.get('view') == 'gone':
                self._close()
                return
            if self not in _live:
                self.close()
                return
            # It is not started again from here: whoever stopped it meant to.
            if not runtime.started or self._node not in (None, runtime.helper):
                self._end('ROS was stopped. Run this cell to start it again.')
                return
            self._seen_at = time.monotonic()
            opened = self._node is None
            if opened:
                self._open()
            if opened or content.get('view') == 'seen':
                self._send(everything=True)

    def _on_timer(self) -> None:
        with self._lock:
            if self._node is None or self._node is not runtime.helper:
                return
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
            self._send()

    def _ask_whether_gone(self, asked_at: float) -> None:
        """Close unless the page speaks up, as soon as the kernel can hear it.

        Where a running cell keeps the kernel from hearing pages, it keeps this waiting too.
        """
        from IPython import get_ipython

        def close() -> None:
            if self._seen_at == asked_at:
                self._close()

        loop = get_ipython().kernel.io_loop
        loop.add_callback(lambda: loop.call_later(CATCH_UP_SEC, close))

    def _send(self, *, everything: bool = False) -> None:
        content, buffers = self._news(everything)
        now = time.monotonic()
        if content or buffers or now - self._sent_at >= STATUS_SEC:
            self._sent_at = now
            self._widget.send(content, buffers or None)

    def _end(self, words: str) -> None:
        _live.pop(self, None)
        self._close()
        if self._widget is not None:
            self._widget.send({'ended': words})


# The views that live, each with the cell and its execution that made it.
_live: dict[Live, tuple[str, str]] = {}


def _look_all() -> None:
    for view in list(_live):
        view._look()


after_destroy.append(_look_all)
