"""The stored form of a live view: its last text or picture, and what to do.

A widget lives as long as its kernel. In a notebook opened the next day JupyterLab finds none, and
its own widget state (`saveState`) is lost when the notebook is saved without the kernel. So a view
has two outputs under its cell: its stored form, which is plain HTML that every viewer can show,
and its widget. The style sheet of the stored form shows one of them: the widget while it exists,
else the stored form. While the widget is in the panel of `lab.dock()`, there is only a line that
says so. On paper it is always the stored form: a widget is as dark as the page's theme.
"""

from __future__ import annotations

import functools
import html
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from labkit.views.themed import as_source, picture

if TYPE_CHECKING:
    from ipywidgets import Widget

    from labkit.views.widget import PageWidget

__all__ = ['Stored']

TODO = 'Run the setup cell at the top, then this one.'
DOCKED = 'The {} is in its panel. Close the panel to have it here.'


class Stored:
    """The stored form of one view.

    Args:
        widget: The view's widget.
        name: What the view is; by default as its widget is called.
        shown: The widget to show, if that is a box around the view's.
    """

    def __init__(self, widget: PageWidget, name: str = '', shown: Widget | None = None) -> None:
        self._widget = shown or widget
        self._name = name or type(widget).__name__.removesuffix('Page').lower()
        # The page puts it on the view, so that the style sheet can tell whether it exists.
        self._mark = widget.mark
        # The current content of the output; None before it is shown.
        self._shown: dict[str, str] | None = None

    def show(self, still: Mapping[str, str]) -> None:
        """Show both outputs under the current cell.

        Args:
            still: Text, `text/plain`, and maybe a picture, `image/svg+xml` or `image/png`, or a
                card, `text/html`, which is as true without a kernel as with one.
        """
        from IPython.display import display

        self._shown = dict(still)
        display(self._bundle(), raw=True, display_id=self._mark)  # type: ignore[no-untyped-call]
        view = {'application/vnd.jupyter.widget-view+json': self._widget.get_view_spec()}
        display(view, raw=True)  # type: ignore[no-untyped-call]

    def update(self, still: Mapping[str, str]) -> None:
        """Replace text and picture in every place where the view is shown."""
        from IPython.display import update_display

        if self._shown is not None and self._shown != still:
            self._shown = dict(still)
            update_display(self._bundle(), raw=True, display_id=self._mark)  # type: ignore[no-untyped-call]

    def _bundle(self) -> dict[str, str]:
        assert self._shown is not None
        style = f'<style class="labkit-style">{_style(self._mark)}</style>'
        if 'text/html' in self._shown:
            card = f'{self._shown["text/html"]}<div>{_button()}</div>'
            kept = f'<div class="labkit-kept {self._mark}-stored">{card}</div>'
            return {**self._shown, 'text/html': style + kept}
        text = self._shown['text/plain']
        # Reached by Tab: what is long scrolls.
        body = f'<pre tabindex="0">{html.escape(text)}</pre>'
        for kind, data in self._shown.items():
            if kind.startswith('image/'):
                # As a separate image: its ids must not clash with those of the live one.
                body = picture(text, as_source(kind, data))
        docked = DOCKED.format(self._name)
        now = datetime.now()
        words = (
            f'Stored on {now.day} {now:%B %Y} at {now:%H:%M:%S}. <span>{TODO}</span> {_button()}'
        )
        page = (
            f'{style}<p class="{self._mark}-docked" hidden>{docked}</p>'
            f'<div class="labkit-stored {self._mark}-stored"><p>{words}</p>{body}</div>'
        )
        return {**self._shown, 'text/html': page}


@functools.lru_cache(maxsize=1)
def _button() -> str:
    """Return a script that puts a button where it stands; without scripts there is none."""
    script = Path(__file__).with_name('bring_back.js').read_text(encoding='utf-8')
    # JupyterLab would take Enter for the cell.
    place = (
        'const place = document.currentScript.parentElement;\n'
        "place.setAttribute('data-lm-suppress-shortcuts', 'true');\n"
        'place.append(bringBackButton());'
    )
    return f'<script>(() => {{\n{script}\n{place}\n}})();</script>'


@functools.lru_cache(maxsize=1)
def _rules() -> str:
    return Path(__file__).with_suffix('.css').read_text(encoding='utf-8')


def _style(mark: str) -> str:
    """Return the style of the stored form, and the rules that hide it while the widget exists."""
    here = f'.jp-OutputArea:has(> .jp-OutputArea-child .{mark}.labkit-view)'
    stored = f'> .jp-OutputArea-child:has(.{mark}-stored)'
    in_panel = f':has(.jupyterlab-sidecar .{mark}.labkit-view)'
    docked = f'body{in_panel} .jp-Notebook'
    return (
        f'{_rules()}\n@media screen {{ body:not({in_panel}) {here} {stored}, '
        f'{docked} .{mark}-stored, '
        f'{docked} .jp-OutputArea-child:has(.{mark}.labkit-view) {{ display: none; }}\n'
        f'{docked} .{mark}-docked {{ display: block; }} }}'
        f'\n@media print {{ .{mark}.labkit-view {{ display: none !important; }} }}'
    )
