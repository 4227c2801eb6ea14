"""Show matplotlib figures in the colours of the page, and in words.

JupyterLab shows a figure's PNG: black on white in any theme, and without a text alternative. So
IPython gets a second form, which it prefers. What is stored and compared, and what other programs
show, is still the PNG.
"""

from __future__ import annotations

import io
import threading
from typing import TYPE_CHECKING, Any

from labkit import settings
from labkit.settings import audience
from labkit.views.themed import as_source, picture, themed

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ['describe', 'figure_html', 'register']

# Drawings of thousands of points would slow the page down: above this many characters, show the
# PNG.
LARGEST = 1_000_000


def register() -> None:
    """Register the figure form with the running IPython, if there is one."""
    shell = settings.shell()
    if shell is not None:
        # Not as `text/html`: matplotlib removes other formatters of figures.
        bundles = shell.display_formatter.mimebundle_formatter
        bundles.for_type_by_name('matplotlib.figure', 'Figure', _bundle)
        _leave_events_to_cells(shell.events)


def _leave_events_to_cells(events: Any) -> None:
    """Let IPython's events happen in the thread that runs the cells, and between them.

    A comm that is heard in another thread (`compat.hear_while_cells_run`) fires `post_execute`
    there. matplotlib then shows, and closes, the figure that a cell is still drawing.
    """
    trigger = events.trigger

    def trigger_between_cells(event: str, *args: Any, **kwargs: Any) -> None:
        if threading.current_thread() is threading.main_thread():
            trigger(event, *args, **kwargs)
            return
        from labkit.background.compat import call_in_kernel  # loads rclpy

        call_in_kernel(lambda: trigger(event, *args, **kwargs))

    events.trigger = trigger_between_cells


def _bundle(figure: Figure) -> dict[str, str]:
    html = figure_html(figure)
    return {} if html is None else {'text/html': html}


def figure_html(figure: Figure) -> str | None:
    """Return a figure as HTML, None where outputs are stored and compared."""
    if audience().same_each_time:
        return None
    words, source = describe(figure), as_source('image/png', _saved(figure, 'png'))
    drawing = _saved(figure, 'svg').decode()
    if len(drawing) > LARGEST:
        return picture(words, source)
    return themed(drawing, words, source)


def describe(figure: Figure) -> str:
    """Return a figure in words: titles, axes, lines and their ranges."""
    plots = [_describe(axes) for axes in figure.axes]
    if not plots:
        return 'An empty figure.'
    if len(plots) == 1:
        return f'A plot: {plots[0]}.'
    numbered = [f'{number}: {plot}.' for number, plot in enumerate(plots, start=1)]
    return ' '.join([f'{len(plots)} plots.', *numbered])


def _describe(axes: Axes) -> str:
    x, y = axes.get_xlabel(), axes.get_ylabel()
    names = [name for name in axes.get_legend_handles_labels()[1] if name]
    counts = {
        'line': len(axes.lines),
        'bar': len(axes.patches),
        'group of points': len(axes.collections),
    }
    things = ', '.join(_count(number, kind) for kind, number in counts.items() if number)
    things = things or 'nothing drawn'
    parts = [
        axes.get_title(),
        f'{y} over {x}' if x and y else y or x,
        f'{things} ({", ".join(names)})' if names else things,
        _range('x', axes.get_xlim()),
        _range('y', axes.get_ylim()),
    ]
    return '; '.join(part for part in parts if part)


def _count(number: int, thing: str) -> str:
    many = {'group of points': 'groups of points'}.get(thing, f'{thing}s')
    return f'1 {thing}' if number == 1 else f'{number} {many}'


def _range(name: str, limits: tuple[float, float]) -> str:
    return f'{name} from {limits[0]:.4g} to {limits[1]:.4g}'


def _saved(figure: Figure, kind: str) -> bytes:
    file = io.BytesIO()
    options: dict[str, Any] = {'metadata': {'Date': None}} if kind == 'svg' else {}
    figure.savefig(file, format=kind, bbox_inches='tight', **options)
    return file.getvalue()
