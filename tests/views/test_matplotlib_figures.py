"""A figure of matplotlib in a cell: in words, and in the colours of the page."""

from __future__ import annotations

import re
from collections.abc import Callable
from html.parser import HTMLParser
from typing import TYPE_CHECKING

import pytest

from labkit import settings
from labkit.views import matplotlib_figures
from labkit.views.matplotlib_figures import describe, figure_html
from tests.conftest import Kernel

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def drawn(title: str = 'Way') -> Figure:
    from matplotlib.figure import Figure

    figure = Figure()
    top, bottom = figure.subplots(2)
    top.plot([0, 1, 2], [0, 1, 4], label='there')
    top.plot([0, 1, 2], [4, 1, 0], label='back')
    top.set(title=title, xlabel='time in s', ylabel='x in m', xlim=(0, 2), ylim=(0, 4))
    top.legend()
    bottom.bar([1, 2, 3], [1, 2, 3])
    bottom.set(xlim=(0, 4), ylim=(0, 3))
    return figure


@pytest.fixture
def learner(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a person look at what is shown."""
    monkeypatch.setattr(matplotlib_figures, 'audience', lambda: settings.LEARNER)


def test_words_say_what_is_drawn() -> None:
    assert describe(drawn()) == (
        '2 plots. 1: Way; x in m over time in s; 2 lines (there, back); x from 0 to 2; y from 0 '
        'to 4. 2: 3 bars; x from 0 to 4; y from 0 to 3.'
    )
    figure = drawn()
    figure.clear()
    assert describe(figure) == 'An empty figure.'
    figure.subplots().set(ylabel='v in m/s')
    assert describe(figure).startswith('A plot: v in m/s; nothing drawn; ')


@pytest.mark.usefixtures('learner')
def test_what_is_black_or_white_follows_the_theme() -> None:
    html = figure_html(drawn())
    assert html is not None
    drawing = html[html.index('<svg') : html.index('</svg>')]
    assert not re.search('(?<!, )#(000000|ffffff)', drawing)
    assert 'var(--jp-content-font-color1, #000000)' in drawing
    assert 'var(--jp-layout-color0, #ffffff)' in drawing
    # Text has no colour of its own.
    assert 'fill: var(--jp-content-font-color1, #000000)' in drawing[: drawing.index('>')]
    assert '#1f77b4' in drawing  # the colour of a line stays


class Tags(HTMLParser):
    """The tags of a page with their attributes."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))


@pytest.mark.usefixtures('learner')
def test_names_in_a_figure_are_text() -> None:
    html = figure_html(drawn('<img src=x onerror="window.hacked = true">'))
    assert html is not None
    tags = Tags(html).found
    assert 'onerror="' in str(tags[0][1]['aria-label'])
    pictures = [attributes for tag, attributes in tags if tag == 'img']
    assert len(pictures) == 1
    assert str(pictures[0]['src']).startswith('data:image/png;base64,')


@pytest.mark.usefixtures('learner')
def test_a_drawing_that_is_too_large_is_a_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(matplotlib_figures, 'LARGEST', 100)
    html = figure_html(drawn())
    assert html is not None
    assert html.startswith('<img alt="2 plots.')
    assert '<svg' not in html


@pytest.mark.slow('runs pytest on notebooks')
def test_what_is_stored_and_compared_is_the_png_alone(start_kernel: Callable[..., Kernel]) -> None:
    # As in a lesson: labkit is there before matplotlib.
    code = 'import labkit\nimport matplotlib.pyplot as plt\nplt.plot([1, 2])\nplt.show()'
    forms = []
    for headless in ('0', '1'):
        result = start_kernel(LABKIT_HEADLESS=headless).run(code)
        assert not result.error
        forms.append(sorted(result.outputs[-1]['data']))
    assert forms == [['image/png', 'text/html', 'text/plain'], ['image/png', 'text/plain']]
