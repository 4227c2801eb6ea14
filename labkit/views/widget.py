"""The browser side of a view: its files, and the widget that loads them."""

from __future__ import annotations

import functools
import uuid
from pathlib import Path

import anywidget
import traitlets

from labkit.background.compat import hear_while_cells_run

__all__ = ['PageWidget', 'page_files', 'widget_class']

# Files that several views share, loaded before the view's own.
_SHARED = {
    'arena': ('over_canvas', 'map', 'occupancy_grid'),
    'bag': ('map', 'chart'),
    'frames': ('drawing',),
    'graph': ('drawing',),
    'guess_form': ('form',),
    'plot': ('chart',),
    'quiz_form': ('form',),
    'scene': ('over_canvas', 'scene_space', 'scene_drawing'),
    'verdict_form': ('form',),
}


def page_files(name: str) -> tuple[str, str]:
    """Return JavaScript and style of a view.

    Args:
        name: Its files are `NAME.js` and `NAME.css`; shared ones come first.
    """
    folder = Path(__file__).parent
    parts = ('bring_back', 'live', *_SHARED.get(name, ()), name)
    script, style = (
        '\n'.join(
            path.read_text(encoding='utf-8')
            for path in (folder / f'{part}{ending}' for part in parts)
            if ending == '.js' or path.is_file()  # not each has a style of its own
        )
        for ending in ('.js', '.css')
    )
    return script, style


class PageWidget(anywidget.AnyWidget):
    """The browser side of a view.

    Attributes:
        mark: A unique class of its element in the page.
        panel: The id of the panel that shows it, '' without one. See `labkit.views.dock`.
    """

    mark = traitlets.Unicode().tag(sync=True)
    panel = traitlets.Unicode().tag(sync=True)

    def open(self) -> None:
        """Open the connection to the page."""
        super().open()
        hear_while_cells_run(self.comm)

    @traitlets.default('mark')
    def _new_mark(self) -> str:
        return f'labkit-{uuid.uuid4().hex}'


@functools.cache
def widget_class(name: str) -> type[PageWidget]:
    """Return the widget class of a view; `name` as for `page_files`."""
    script, style = page_files(name)
    files = {'_esm': script, '_css': style}
    # anywidget names the style after the class.
    return type(f'{name.capitalize()}Page', (PageWidget,), files)
