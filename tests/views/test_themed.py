"""A still picture in the colours of the page."""

from __future__ import annotations

import re
from html.parser import HTMLParser

from labkit.sim.kinematics import Pose
from labkit.views.arena_picture import Scene, row
from labkit.views.themed import as_source, picture, themed


def test_colours_of_a_drawing_are_those_of_the_page() -> None:
    drawing = row([Scene(pose=Pose(), scan=[(1.0, 0.0), (1.0, 0.1)])], 'a drive')
    html = themed(drawing, 'a drive', as_source('image/svg+xml', drawing.encode()))
    inline = html[: html.index('<template>')]
    assert not re.search('(?:fill|stroke)="#', inline)
    assert 'fill: var(--jp-layout-color0, #ffffff)' in inline
    assert 'stroke: var(--jp-content-font-color1, #37474f)' in inline
    assert '#ef6c00' in inline  # the robot keeps its colour
    # Where there are two colours, both are kept.
    assert re.search(r'style="fill: var\([^"]*\); stroke: var\([^"]*\)"', inline)
    # The same number of elements, each with one style at most.
    assert len(re.findall('<[a-z]', inline)) == len(re.findall('<[a-z]', drawing)) + 1
    for tag in re.findall('<[a-z][^<>]*>', inline):
        assert tag.count('style=') <= 1, tag


def test_image_of_a_drawing_turns_by_night_and_a_photograph_does_not() -> None:
    drawing = picture('a drive', as_source('image/svg+xml', '<svg></svg>'))
    assert 'src="data:image/svg+xml;base64,PHN2Zz48L3N2Zz4="' in drawing
    assert 'class="labkit-drawing"' in drawing and '@media screen' in drawing
    photograph = picture('a wall', as_source('image/png', 'cGljdHVyZQ=='))
    assert photograph == picture('a wall', as_source('image/png', b'picture'))
    assert 'class' not in photograph and 'filter' not in photograph


def test_words_of_others_are_only_words() -> None:
    words = '"><script>alert(1)</script>'
    html = themed('<svg></svg>', words, as_source('image/png', b'picture'))
    tags: list[tuple[str, dict[str, str | None]]] = []

    class Reader(HTMLParser):
        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            tags.append((tag, dict(attrs)))

    Reader().feed(html)
    assert [tag for tag, _ in tags] == ['div', 'svg', 'template', 'img']
    assert tags[0][1]['aria-label'] == tags[3][1]['alt'] == words
    assert tags[3][1]['src'] == 'data:image/png;base64,cGljdHVyZQ=='
