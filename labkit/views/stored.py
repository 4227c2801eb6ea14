"""What stays of a live view in the notebook: its last text or picture, and what to do.

A widget lives as long as its kernel. In a notebook that is opened the next day JupyterLab finds
none, and what it keeps of widgets by itself (`saveState`) is lost again when the notebook is saved
without the kernel. So a view has two outputs under its cell: its stored form, which is plain HTML
that every viewer can show, and its widget. The style that comes with the stored form shows one of
them: the widget while it is there, else the stored form. On paper it is the stored form always:
what a widget draws is as dark as the page's theme.
"""

from __future__ import annotations

import functools
import html
from base64 import b64encode
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from labkit.views.widget import PageWidget

__all__ = ['Stored']

TODO = 'Run this cell again.'


class Stored:
    """The stored form of one view.

    Args:
        widget: The view's part in the page.
    """

    def __init__(self, widget: PageWidget) -> None:
        self._widget = widget
        # The page puts it on the view, so that the style knows whether it is there.
        self._mark = widget.mark
        # What is in the notebook; None as long as nothing is shown.
        self._kept: dict[str, str] | None = None

    def show(self, still: Mapping[str, str]) -> None:
        """Show both under the current cell.

        Args:
            still: Text, `text/plain`, and maybe a picture, `image/svg+xml` or `image/png`.
        """
        from IPython.display import display

        self._kept = dict(still)
        display(self._bundle(), raw=True, display_id=self._mark)  # type: ignore[no-untyped-call]
        view = {'application/vnd.jupyter.widget-view+json': self._widget.get_view_spec()}
        display(view, raw=True)  # type: ignore[no-untyped-call]

    def keep(self, still: Mapping[str, str]) -> None:
        """Keep another text and picture from now on, wherever the view is shown."""
        from IPython.display import update_display

        if self._kept is not None and self._kept != still:
            self._kept = dict(still)
            update_display(self._bundle(), raw=True, display_id=self._mark)  # type: ignore[no-untyped-call]

    def _bundle(self) -> dict[str, str]:
        assert self._kept is not None
        text = self._kept['text/plain']
        body = f'<pre>{html.escape(text)}</pre>'
        for kind, data in self._kept.items():
            if kind.startswith('image/'):
                # As a picture of its own: names inside do not meet those of the live one.
                source = data if kind == 'image/png' else b64encode(data.encode()).decode()
                words = html.escape(text)
                body = f'<img src="data:{kind};base64,{source}" alt="{words}">'
        now = datetime.now()
        words = f'Stored on {now.day} {now:%B %Y} at {now:%H:%M:%S}. <span>{TODO}</span>'
        page = (
            f'<style class="labkit-style">{_style(self._mark)}</style>'
            f'<div class="labkit-stored {self._mark}-stored"><p>{words}</p>{body}</div>'
        )
        return {**self._kept, 'text/html': page}


@functools.lru_cache(maxsize=1)
def _rules() -> str:
    return Path(__file__).with_suffix('.css').read_text(encoding='utf-8')


def _style(mark: str) -> str:
    """Return the style of the stored form, and what hides it while the view is there."""
    here = f'.jp-OutputArea:has(> .jp-OutputArea-child .{mark}.labkit-view)'
    stored = f'> .jp-OutputArea-child:has(.{mark}-stored)'
    return (
        f'{_rules()}\n@media screen {{ {here} {stored} {{ display: none; }} }}'
        f'\n@media print {{ .{mark}.labkit-view {{ display: none !important; }} }}'
    )
