"""The part of a view that lives in the page: its files, and what makes a notebook show it."""

from __future__ import annotations

import functools
import uuid
from pathlib import Path

import anywidget
import traitlets

from labkit.background.compat import hear_while_cells_run

__all__ = ['PageWidget', 'page_files', 'widget_class']

# What else the page's part of a view is made of. It goes before its own.
_SHARED = {'arena': ('map', 'seen'), 'bag': ('map', 'lines'), 'plot': ('lines',)}


def page_files(name: str) -> tuple[str, str]:
    """Return JavaScript and style of a view's part in the page.

    Args:
        name: Its files are `NAME.js` and `NAME.css`; what several views share goes before.
    """
    folder = Path(__file__).parent
    parts = ('live', *_SHARED.get(name, ()), name)
    script, style = (
        '\n'.join(path.read_text(encoding='utf-8') for path in paths if path.is_file())
        for paths in ([folder / f'{part}.{ending}' for part in parts] for ending in ('js', 'css'))
    )
    return script, style


class PageWidget(anywidget.AnyWidget):
    """The part of a view in the page.

    Attributes:
        mark: A class of the view's place in the page, which no other one has.
    """

    mark = traitlets.Unicode().tag(sync=True)

    def open(self) -> None:
        """Let the page know of it."""
        super().open()
        hear_while_cells_run(self.comm)

    @traitlets.default('mark')
    def _new_mark(self) -> str:
        return f'labkit-{uuid.uuid4().hex}'


@functools.cache
def widget_class(name: str) -> type[PageWidget]:
    """Return the class of a view's part in the page.

    Args:
        name: See `page_files`.
    """
    script, style = page_files(name)
    files = {'_esm': script, '_css': style}
    # anywidget takes the name of the class for that of its style.
    return type(f'{name.capitalize()}Page', (PageWidget,), files)
