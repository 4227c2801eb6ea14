"""The course as a picture: a road with a station for each lesson, which fills as one goes.

It is decoration: the table below it says the same to a screen reader and to the keyboard.
"""

from __future__ import annotations

import html
import math
import textwrap
from collections.abc import Sequence
from datetime import date

from labkit.views.progress_picture import Row, percent

__all__ = ['course_map', 'earned', 'linked_map']

# Stations in a row of the road; their distances, and the radius of one, in units of the picture.
A_ROW = 5
ACROSS, DOWN, DOWN_UNTITLED, RADIUS = 130, 96, 64, 18
# Left and above the first station.
MARGIN_X, MARGIN_Y = 90, 40
# A page that has no theme of JupyterLab, such as an image, takes the second colour: a grey that
# can be read on white and on black.
_TEXT = 'var(--jp-content-font-color1, #767676)'
_OPEN = 'var(--jp-border-color1, #9e9e9e)'
_DONE = 'var(--jp-success-color1, #2e7d32)'
_CERTIFICATE = (
    f'max-width:30em;margin:0 0 1em;padding:1em;text-align:center;border:4px double {_DONE}'
)
_LINK = 'position:absolute;left:{x:.2f}%;top:{y:.2f}%;width:{width:.2f}%;height:{height:.2f}%'


def course_map(rows: Sequence[Row], here: str = '', *, titles: bool = True) -> str:
    """Return the picture as SVG.

    Args:
        rows: The lessons.
        here: File name of the lesson where the learner is; the robot stands there.
        titles: Whether to write the titles of the lessons below the stations.
    """
    down = DOWN if titles else DOWN_UNTITLED
    width, height = _size(rows, down)
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'width="{width}" height="{height}" style="max-width:100%;height:auto;display:block" '
        'font-family="sans-serif" text-anchor="middle" aria-hidden="true">'
    ]
    for number, row in enumerate(rows):
        if number + 1 < len(rows):
            colour = _DONE if percent(row.items) == 100 else _OPEN
            parts.append(
                f'<path d="{_road(number, down)}" fill="none" stroke="{colour}" stroke-width="5"/>'
            )
        robot = bool(here) and row.href == here
        parts.append(_station(_place(number, down), row, robot=robot, titles=titles))
    return '\n'.join([*parts, '</svg>'])


def linked_map(rows: Sequence[Row], here: str = '') -> str:
    """Return the picture as HTML, in which a click on a station opens its lesson."""
    width, height = _size(rows, DOWN)
    links = []
    for number, row in enumerate(rows):
        if not row.href:
            continue
        x, y = _place(number, DOWN)
        place = _LINK.format(
            x=100 * (x - ACROSS / 2) / width,
            y=100 * (y - RADIUS) / height,
            width=100 * ACROSS / width,
            height=100 * (DOWN - RADIUS) / height,
        )
        # The table has the same link for the keyboard.
        words = html.escape(f'{row.title}: {percent(row.items)} %{row.time(", ")}')
        links.append(
            f'<a href="{html.escape(row.href)}" title="{words}" aria-hidden="true" '
            f'tabindex="-1" style="{place}"></a>'
        )
    return '\n'.join(
        [
            f'<div style="position:relative;max-width:{width}px;margin:0 0 0.6em">',
            course_map(rows, here),
            *links,
            '</div>',
        ]
    )


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


def _size(rows: Sequence[Row], down: int) -> tuple[int, int]:
    lines = max(math.ceil(len(rows) / A_ROW), 1)
    return 2 * MARGIN_X + (A_ROW - 1) * ACROSS, MARGIN_Y + lines * down


def _place(number: int, down: int) -> tuple[int, int]:
    """Return the centre of a station; every other row of the road leads back."""
    line, place = divmod(number, A_ROW)
    column = place if line % 2 == 0 else A_ROW - 1 - place
    return MARGIN_X + column * ACROSS, MARGIN_Y + line * down


def _road(number: int, down: int) -> str:
    """Return the path from a station to the next one, from rim to rim."""
    (x, y), (next_x, next_y) = _place(number, down), _place(number + 1, down)
    if y == next_y:
        side = RADIUS if next_x > x else -RADIUS
        return f'M{x + side} {y}H{next_x - side}'
    # At the end of a row it turns back, in half a circle.
    side, bow = (RADIUS, 1) if x > MARGIN_X else (-RADIUS, 0)
    half = down // 2
    return f'M{x + side} {y}a{half} {half} 0 0 {bow} 0 {down}'


def _station(place: tuple[int, int], row: Row, *, robot: bool, titles: bool) -> str:
    x, y = place
    ring = f'<circle r="{RADIUS}" fill="none" stroke-width="5"'
    around = round(2 * math.pi * RADIUS, 1)
    done = round(around * percent(row.items) / 100, 1)
    name, _, title = row.title.partition(' ')
    parts = [f'<g transform="translate({x} {y})">', f'{ring} stroke="{_OPEN}"/>']
    if done:
        parts.append(
            f'{ring} stroke="{_DONE}" stroke-dasharray="{done} {around}" transform="rotate(-90)"/>'
        )
    parts.append(
        f'<text y="5" font-size="14" font-weight="bold" fill="{_TEXT}">{html.escape(name)}</text>'
    )
    if titles:
        lines = textwrap.wrap(title, 17, max_lines=2, placeholder=' …')
        parts += [
            f'<text y="{RADIUS + 17 + 14 * number}" font-size="12" fill="{_TEXT}">'
            f'{html.escape(line)}</text>'
            for number, line in enumerate(lines)
        ]
    if robot:
        # The robot of the course from above, driving to the right.
        parts.append(
            f'<g transform="translate(0 {-RADIUS - 14}) rotate(90) scale(1.3)" fill="none" '
            f'stroke="{_TEXT}" stroke-width="1.5"><path d="M-8 -3V4M8 -3V4"/>'
            f'<path d="M-6 10V-4H6V10Z"/><path d="M0 -9L4 -4H-4Z" fill="{_DONE}" stroke="none"/>'
            '</g>'
        )
    return ''.join([*parts, '</g>'])
