"""The course as a picture: a road with a station for each lesson, which fills as one goes.

Each station is a picture of its own and a link, so that a mouse and the keyboard open a lesson,
and the road goes on in the next line where a page is narrow.
"""

from __future__ import annotations

import html
import math
import textwrap
from base64 import b64encode
from collections.abc import Sequence
from datetime import date

from labkit.views.progress_picture import Row, percent

__all__ = ['course_map', 'earned', 'markdown_map']

# Size of a station's picture, the height of the road in it, and the radius of its ring, in pixels.
WIDTH, HEIGHT, ROAD, RADIUS = 126, 104, 42, 18
# A page that has no theme of JupyterLab, such as an image, takes the second colour: a grey that
# can be read on white and on black.
_TEXT = 'var(--jp-content-font-color1, #767676)'
_OPEN = 'var(--jp-border-color1, #9e9e9e)'
_DONE = 'var(--jp-success-color1, #2e7d32)'
_CERTIFICATE = (
    f'max-width:30em;margin:0 0 1em;padding:1em;text-align:center;border:4px double {_DONE}'
)


def course_map(rows: Sequence[Row], here: str = '') -> str:
    """Return the road as HTML.

    Args:
        rows: The lessons.
        here: File name of the lesson where the learner is; the robot stands there.
    """
    parts = ['<div style="display:flex;flex-wrap:wrap;margin:0 0 0.6em">']
    for row, drawn in zip(rows, _stations(rows, here), strict=True):
        words = html.escape(_words(row))
        if row.href:
            href = html.escape(row.href)
            parts.append(f'<a href="{href}" title="{words}" aria-label="{words}">{drawn}</a>')
        else:
            parts.append(f'<span role="img" title="{words}" aria-label="{words}">{drawn}</span>')
    return '\n'.join([*parts, '</div>'])


def markdown_map(rows: Sequence[Row], here: str = '') -> str:
    """Return the road as Markdown, for a page that shows no SVG but as an image."""
    parts = []
    for row, drawn in zip(rows, _stations(rows, here), strict=True):
        words = _words(row).replace('[', '(').replace(']', ')')
        image = f'![{words}](data:image/svg+xml;base64,{b64encode(drawn.encode()).decode()})'
        parts.append(f'[{image}]({row.href})' if row.href else image)
    # Nothing between them: the road has no gaps.
    return ''.join(parts)


def earned(rows: Sequence[Row], first: date, last: date) -> str:
    """Return the certificate as HTML, for somebody who has solved all exercises.

    Args:
        rows: The lessons.
        first: The first day of work.
        last: The last one.
    """
    done = Row('', [item for row in rows for item in row.items]).counts()
    days = f'from {_day(first)} to {_day(last)}' if first != last else f'on {_day(first)}'
    return (
        f'<div style="{_CERTIFICATE}"><div style="font-size:1.6em">Learn ROS 2</div>'
        f'<p>Certificate: all exercises of its {len(rows)} lessons are solved.<br/>'
        f'{html.escape(done)},<br/>{days}.</p>'
        '</div>'
    )


def _day(day: date) -> str:
    return f'{day.day} {day:%B %Y}'


def _words(row: Row) -> str:
    return f'{row.title}: {percent(row.items)} %{row.time(", ")}'


def _stations(rows: Sequence[Row], here: str) -> list[str]:
    """Return the pictures of the stations, as SVG."""
    drawn, arrives = [], ''
    for number, row in enumerate(rows):
        leaves = _DONE if percent(row.items) == 100 else _OPEN
        roads = [('0', arrives)] if number else []
        if number + 1 < len(rows):
            roads.append((str(WIDTH // 2 + RADIUS), leaves))
        drawn.append(_station(row, roads, robot=bool(here) and row.href == here))
        arrives = leaves
    return drawn


def _station(row: Row, roads: Sequence[tuple[str, str]], *, robot: bool) -> str:
    ring = f'<circle r="{RADIUS}" fill="none" stroke-width="5"'
    around = round(2 * math.pi * RADIUS, 1)
    done = round(around * percent(row.items) / 100, 1)
    name, _, title = row.title.partition(' ')
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" '
        f'height="{HEIGHT}" style="display:block" font-family="sans-serif" text-anchor="middle" '
        'aria-hidden="true">',
        *(
            f'<path d="M{start} {ROAD}h{WIDTH // 2 - RADIUS}" stroke="{colour}" stroke-width="5"/>'
            for start, colour in roads
        ),
        f'<g transform="translate({WIDTH // 2} {ROAD})">',
        f'{ring} stroke="{_OPEN}"/>',
    ]
    if done:
        parts.append(
            f'{ring} stroke="{_DONE}" stroke-dasharray="{done} {around}" transform="rotate(-90)"/>'
        )
    parts.append(
        f'<text y="5" font-size="14" font-weight="bold" fill="{_TEXT}">{html.escape(name)}</text>'
    )
    parts += [
        f'<text y="{RADIUS + 17 + 14 * number}" font-size="12" fill="{_TEXT}">'
        f'{html.escape(line)}</text>'
        for number, line in enumerate(textwrap.wrap(title, 17, max_lines=2, placeholder=' …'))
    ]
    if robot:
        # The robot of the course from above, driving to the right.
        parts.append(
            f'<g transform="translate(0 {-RADIUS - 14}) rotate(90) scale(1.3)" fill="none" '
            f'stroke="{_TEXT}" stroke-width="1.5"><path d="M-8 -3V4M8 -3V4"/>'
            f'<path d="M-6 10V-4H6V10Z"/><path d="M0 -9L4 -4H-4Z" fill="{_DONE}" stroke="none"/>'
            '</g>'
        )
    return ''.join([*parts, '</g></svg>'])
