"""A figure of matplotlib in a cell: in the colours of the page, and in words.

JupyterLab shows the figure's PNG: black on white whatever the theme, and without a word for those
who do not see it. So IPython is told a second form, which it is shown first. What is stored and
compared, and what other programs show, is the PNG as before.
"""

from __future__ import annotations

import base64
import io
import re
import sys
from html import escape
from typing import TYPE_CHECKING, Any

from labkit.settings import audience

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ['describe', 'figure_html', 'register']

# A drawing of many thousand points would make the page slow: beyond so many characters the PNG
# is shown, on white paper.
LARGEST = 1_000_000
# What is black in a figure is text and axes, and white is its paper.
_THEME = {
    '#000000': 'var(--jp-content-font-color1, #000)',
    '#ffffff': 'var(--jp-layout-color0, #fff)',
}
_STYLE = 'max-width: 100%; height: auto'


def register() -> None:
    """Let the running IPython show figures in the page's colours; without one nothing happens."""
    ipython = sys.modules.get('IPython')
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is not None:
        html = shell.display_formatter.formatters['text/html']
        html.for_type_by_name('matplotlib.figure', 'Figure', figure_html)


def figure_html(figure: Figure) -> str | None:
    """Return a figure as HTML, None where it is stored and compared."""
    if audience().same_each_time:
        return None
    words = escape(describe(figure))
    picture = f'<img alt="{words}" src="data:image/png;base64,{_png(figure)}" style="{_STYLE}">'
    drawing = _svg(figure)
    if len(drawing) > LARGEST:
        return picture
    # A page that does not trust the notebook takes away the drawing and the `template` around the
    # picture, which nobody sees else.
    return f'<div role="img" aria-label="{words}">{drawing}</div><template>{picture}</template>'


def describe(figure: Figure) -> str:
    """Return what a figure shows, in words: titles, axes, lines and where they go."""
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


def _svg(figure: Figure) -> str:
    text = _saved(figure, 'svg').decode()
    drawing = text[text.index('<svg') :]
    drawing = drawing.replace('<svg', f'<svg aria-hidden="true" style="{_STYLE}"', 1)
    return re.sub('#(?:000000|ffffff)', lambda found: _THEME[found[0]], drawing)


def _png(figure: Figure) -> str:
    return base64.b64encode(_saved(figure, 'png')).decode()


def _saved(figure: Figure, kind: str) -> bytes:
    file = io.BytesIO()
    options: dict[str, Any] = {'metadata': {'Date': None}} if kind == 'svg' else {}
    figure.savefig(file, format=kind, bbox_inches='tight', **options)
    return file.getvalue()
