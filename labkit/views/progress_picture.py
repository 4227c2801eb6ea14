"""The picture of a learner's progress: one line a lesson, one square an exercise or question.

A square says by its sign, not only by its colour, whether it is done, tried or open. The same
stands in the picture's text alternative and in a table under it.
"""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ['Item', 'Row', 'picture', 'text_form']

# state -> (sign, colour, word)
_STATES = {
    'done': ('✔', 'var(--jp-success-color1, #2e7d32)', 'done'),
    'tried': ('…', 'var(--jp-warn-color1, #ef6c00)', 'tried'),
    'open': ('', 'var(--jp-border-color1, #9e9e9e)', 'open'),
}
_SIDE = 18
_GAP = 4
_LINE = 30
_LEFT = 190
_PER_LINE = 24


@dataclass(frozen=True)
class Item:
    """An exercise or a quiz question.

    Attributes:
        kind: `'exercise'` or `'question'`.
        name: Its name.
        state: `'done'`, `'tried'` or `'open'`.
    """

    kind: str
    name: str
    state: str


@dataclass(frozen=True)
class Row:
    """A lesson.

    Attributes:
        title: Its name.
        items: What it asks for.
    """

    title: str
    items: Sequence[Item]

    def counts(self) -> str:
        """Return how much is done, in words: `'1 of 3 exercises, 0 of 8 questions'`."""
        return ', '.join(
            f'{sum(item.state == "done" for item in group)} of {len(group)} {kind}'
            + 's' * (len(group) != 1)
            for kind, group in self.groups()
        )

    def groups(self) -> list[tuple[str, list[Item]]]:
        """Return the items by kind; kinds that do not occur are left out."""
        kinds = ('exercise', 'question')
        found = [(kind, [item for item in self.items if item.kind == kind]) for kind in kinds]
        return [(kind, group) for kind, group in found if group]


def text_form(rows: Sequence[Row], note: str = '') -> str:
    """Return progress as lines of text."""
    everything = Row('', [item for row in rows for item in row.items])
    lines = [f'Progress: {everything.counts() or "no exercises here"} done']
    width = max((len(row.title) for row in rows), default=0)
    for row in rows:
        lines.append(f'  {row.title:<{width}}  {row.counts()}')
        if all(item.state == 'open' for item in row.items):
            continue
        for item in row.items:
            if item.kind == 'exercise':
                lines.append(f'    {item.state:<5}  {item.name}')
    return '\n'.join([*lines, *filter(None, [note])])


def picture(rows: Sequence[Row], note: str = '') -> str:
    """Return progress as HTML: a picture, its text alternative, a table to unfold."""
    parts, top = [], _GAP
    for row in rows:
        drawn, height = _draw(row, top)
        parts.append(drawn)
        top += height
    width = _LEFT + _PER_LINE * (_SIDE + _GAP) + _GAP
    summary = html.escape(text_form(rows).replace('\n', '; '))
    svg = (
        f'<svg role="img" aria-label="{summary}" viewBox="0 0 {width} {top}" '
        f'width="{width}" style="max-width:100%;color:var(--jp-content-font-color1, inherit)" '
        f'xmlns="http://www.w3.org/2000/svg">{"".join(parts)}</svg>'
    )
    legend = '✔ done, … tried, empty: open. Squares: exercises. Circles: quiz questions.'
    return (
        f'<div>{svg}<div>{legend}</div>'
        + (f'<div role="status">{html.escape(note)}</div>' if note else '')
        + '<details><summary>The same as text</summary>'
        f'<pre>{html.escape(text_form(rows))}</pre></details></div>'
    )


def _draw(row: Row, top: int) -> tuple[str, int]:
    """Return the drawing of one lesson, and its height in pixels."""
    parts = [
        f'<text x="0" y="{top + 14}" font-size="13" fill="currentColor">'
        f'{html.escape(row.title)}</text>'
    ]
    line = 0
    for _, group in row.groups():
        for position, item in enumerate(group):
            x = _LEFT + position % _PER_LINE * (_SIDE + _GAP)
            y = top + (line + position // _PER_LINE) * (_SIDE + _GAP)
            parts.append(_draw_item(item, x, y))
        line += (len(group) - 1) // _PER_LINE + 1
    return ''.join(parts), max(line, 1) * (_SIDE + _GAP) + _LINE - _SIDE - _GAP


def _draw_item(item: Item, x: int, y: int) -> str:
    sign, colour, word = _STATES[item.state]
    radius = 2 if item.kind == 'exercise' else _SIDE // 2
    # The colour is that of the edge: the sign is drawn in the colour of text, on the page's own
    # background, so that it can be read in any theme.
    return (
        f'<g><title>{html.escape(f"{item.kind} {item.name}: {word}")}</title>'
        f'<rect x="{x + 1}" y="{y + 1}" width="{_SIDE - 2}" height="{_SIDE - 2}" rx="{radius}" '
        f'fill="transparent" stroke="{colour}" stroke-width="2"/>'
        f'<text x="{x + _SIDE / 2}" y="{y + 13}" font-size="12" text-anchor="middle" '
        f'fill="currentColor">{sign}</text></g>'
    )
