"""Views in JupyterLab's side panel, where they stay while lessons scroll: `lab.dock()`.

The panel is the widget Sidecar of jupyter-widgets. A view is shown in it and under its cell, where
it is hidden as long as the panel has it. So it is seen where there is no such panel, and is back
when the panel is closed.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from labkit.errors import LabError, quoted
from labkit.views.graph import GraphView
from labkit.views.live import live_views
from labkit.views.live_page import LivePage

__all__ = ['TITLE', 'dock', 'show_cell', 'show_panel']

TITLE = 'Robot'
_VIEW = 'application/vnd.jupyter.widget-view+json'

# The panels of this notebook, by title.
_panels: dict[str, Any] = {}


def dock(*views: LivePage | GraphView, title: str = TITLE) -> None:
    """Keep views in sight: show them in the panel on the right of JupyterLab.

    They stay there while the notebook scrolls, and while another notebook is looked at. Where
    JupyterLab's panel is missing, as in another editor, they are under the cell as usual; when the
    panel is closed, they are there again. In a page of less than 1,200 pixels the list of files is
    folded for it, and in one of less than 900 it lies under the notebook.

    The key F6 goes from a cell to the panel and back, and Esc goes back to the cell.

    Args:
        views: What `lab.arena()`, `lab.teleop()`, `lab.image()`, `lab.monitor()`, `lab.plot()`,
            `lab.graph()`, `lab.frames()` or `lab.scene()` return. Without any: those that are live
            in this notebook.
        title: The title of the panel. It takes the place of an earlier one with that title.

    Raises:
        LabError: One of them is no live view, or none is live.
    """
    from IPython.display import display

    wrong = next((view for view in views if not isinstance(view, (LivePage, GraphView))), None)
    if wrong is not None:
        raise LabError(
            f'lab.dock takes live views, and got {quoted(wrong)}.',
            todo='lab.dock(lab.arena(), lab.teleop())',
        )
    live = [view for view in views or live_views() if isinstance(view, LivePage)]
    if not (views or live):
        raise LabError(
            'lab.dock() has found no live view in this notebook.',
            todo='lab.dock(lab.arena(), lab.teleop())',
        )
    for view in views:  # one by one: an editor takes the parameters of `display(*views)` for ours
        display(view)  # type: ignore[no-untyped-call]
    show_panel(title, live)


def show_cell(view: LivePage) -> None:
    """Show a view in the panel, with the others of its cell, such as keys beside a map."""
    request = view._cell.request_id
    views = [other for other in live_views() if other._cell.request_id == request]
    show_panel(TITLE, [other for other in views if isinstance(other, LivePage)])


def show_panel(title: str, views: Iterable[LivePage]) -> None:
    """Show views in the panel of a title, as far as a page can show them."""
    from sidecar import Sidecar  # type: ignore[import-untyped]

    widgets = [view._widget for view in views if view._widget is not None]
    if not widgets:
        return
    if title in _panels:
        _panels[title].close()
    outputs = tuple(
        {'output_type': 'display_data', 'data': {_VIEW: widget.get_view_spec()}, 'metadata': {}}
        for widget in widgets
    )
    _panels[title] = panel = Sidecar(title=title, outputs=outputs)
    for widget in widgets:
        widget.panel = panel.model_id
