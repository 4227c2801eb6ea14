"""The picture of a learner's progress: one row per lesson, one mark per exercise.

A mark is a link to the exercise, and shows by its sign, not only by colour, whether it is done,
tried or open. Text says the same.
"""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ['Item', 'Row', 'link', 'marks', 'percent', 'picture', 'sign', 'text_form']

# state -> (sign, colour, word)
_STATES = {
    'done': ('✔', 'var(--jp-success-color1, #2e7d32)', 'done'),
    'tried': ('…', 'var(--jp-warn-color1, #ef6c00)', 'tried'),
    'open': ('○', 'var(--jp-border-color1, #9e9e9e)', 'open'),
}
_FONT = 'color:var(--jp-content-font-color1, inherit)'
_LINK = 'color:var(--jp-content-link-color, inherit)'
_MARK = (
    'display:inline-block;border:1px solid {colour};border-radius:0.8em;padding:0 0.6em;'
    'margin:0.15em 0.3em 0.15em 0;white-space:nowrap;text-decoration:none;'
    f'{_FONT}'
)
_CELL = 'padding:0.4em 1.2em 0.4em 0;text-align:left;vertical-align:baseline;{more}'
_BAR = (
    'display:inline-block;box-sizing:border-box;width:{width}em;height:0.7em;'
    'border:1px solid var(--jp-border-color1, #9e9e9e);border-radius:0.35em;overflow:hidden'
)
_DONE = 'display:block;width:{part}%;height:100%;background:var(--jp-success-color1, #2e7d32)'


@dataclass(frozen=True)
class Item:
    """An exercise or a quiz question.

    Attributes:
        kind: `'exercise'` or `'question'`.
        state: `'done'`, `'tried'` or `'open'`.
        href: Link to it, `''` if unknown.
    """

    kind: str
    name: str
    state: str
    href: str = ''


@dataclass(frozen=True)
class Row:
    """A lesson.

    Attributes:
        items: Its exercises and questions.
        href: Link to it, `''` if unknown.
        teaches: What it teaches.
        minutes: How long it takes, 0 if unknown.
    """

    title: str
    items: Sequence[Item]
    href: str = ''
    teaches: str = ''
    minutes: int = 0

    def counts(self) -> str:
        """Return the completed items in words: `'1 of 3 exercises, 0 of 8 questions'`."""
        return ', '.join(
            f'{_done(group)} of {len(group)} {kind}' + 's' * (len(group) != 1)
            for kind, group in self.groups()
        )

    def time(self, before: str = '') -> str:
        """Return how long it takes in words, with `before` in front; '' if unknown."""
        return f'{before}{self.minutes} min' if self.minutes else ''

    def groups(self) -> list[tuple[str, list[Item]]]:
        """Return the items by kind, without empty kinds."""
        kinds = ('exercise', 'question')
        found = [(kind, self.of_kind(kind)) for kind in kinds]
        return [(kind, group) for kind, group in found if group]

    def of_kind(self, kind: str) -> list[Item]:
        """Return the items of one kind."""
        return [item for item in self.items if item.kind == kind]


def percent(items: Sequence[Item]) -> int:
    """Return how much is done, in percent: 0 only if nothing is, 100 only if all is.

    Exercises count, for they are the work. A lesson without any is done by its questions.
    """
    counted = [item for item in items if item.kind == 'exercise'] or items
    done = _done(counted)
    return max(100 * done // max(len(counted), 1), min(done, 1))


def text_form(rows: Sequence[Row], note: str = '') -> str:
    """Return progress as lines of text."""
    everything = _everything(rows)
    lines = [f'Progress: {everything.counts() or "no exercises here"} done']
    width = max((len(row.title) for row in rows), default=0)
    for row in rows:
        lines.append(f'  {row.title:<{width}}  {row.counts()}')
        if all(item.state == 'open' for item in row.items):
            continue
        for item in row.of_kind('exercise'):
            lines.append(f'    {item.state:<5}  {item.name}')
    return '\n'.join([*lines, *filter(None, [note])])


def picture(
    rows: Sequence[Row],
    note: str = '',
    onward: Sequence[tuple[str, str]] = (),
    *,
    above: str = '',
) -> str:
    """Return progress as HTML: in total, and by lesson.

    Args:
        rows: The lessons.
        note: A remark below the table.
        onward: Links to what comes next: pairs of text and target.
        above: HTML above the table.
    """
    everything = _everything(rows)
    share = percent(everything.items)
    parts = [
        f'<div style="{_FONT};max-width:60em">',
        f'<p style="margin:0 0 0.6em">{_bar(share, 12)} <strong>{share} %</strong> of the '
        f'exercises: {everything.counts() or "none here"}</p>',
        above,
        *(f'<p style="margin:0 0 0.6em">Go on: {link(*place)}</p>' for place in onward),
        '<table style="border-collapse:collapse;font-size:inherit;margin:0">',
        '<thead><tr>',
        *(
            f'<th scope="col" style="{_CELL.format(more="font-weight:bold")}">{name}</th>'
            for name in ('Lesson', 'Time', 'Done', 'Exercises', 'Quiz')
        ),
        '</tr></thead><tbody>',
        *map(_line, rows),
        '</tbody></table>',
        '<p style="margin:0.6em 0 0">✔ done, … tried, ○ open.</p>',
    ]
    if note:
        parts.append(f'<p role="status" style="margin:0.6em 0 0">{html.escape(note)}</p>')
    return '\n'.join([*parts, '</div>'])


def marks(items: Sequence[Item]) -> str:
    """Return a mark per item as HTML: its sign, name and link."""
    return ' '.join(map(_mark, items))


def sign(item: Item) -> str:
    """Return the sign of an item's state."""
    return _STATES[item.state][0]


def link(text: str, href: str) -> str:
    """Return a link as HTML; only the text without a target."""
    if not href:
        return html.escape(text)
    return f'<a href="{html.escape(href)}" style="{_LINK}">{html.escape(text)}</a>'


def _line(row: Row) -> str:
    share, questions = percent(row.items), row.of_kind('question')
    quiz = f'{_done(questions)} of {len(questions)}' if questions else ''
    cells = [
        f'{_bar(share, 4)} {share} %',
        marks(row.of_kind('exercise')),
        quiz,
    ]
    tight = _CELL.format(more='white-space:nowrap')
    start = f'<th scope="row" style="{_CELL.format(more="font-weight:normal")}">'
    return (
        f'<tr style="background:none">{start}{link(row.title, row.href)}</th>'
        f'<td style="{tight}">{row.time()}</td>'
        f'<td style="{tight}">{cells[0]}</td>'
        f'<td style="{_CELL.format(more="")}">{cells[1]}</td>'
        f'<td style="{tight}">{cells[2]}</td></tr>'
    )


def _mark(item: Item) -> str:
    _, colour, word = _STATES[item.state]
    text = f'<span aria-hidden="true">{sign(item)}</span> {html.escape(item.name)}'
    label = html.escape(f'{item.kind} {item.name}: {word}')
    # Only the border is coloured: the text stays readable in any theme.
    style = f'style="{_MARK.format(colour=colour)}" title="{label}"'
    if not item.href:
        return f'<span role="img" aria-label="{label}" {style}>{text}</span>'
    return f'<a href="{html.escape(item.href)}" aria-label="{label}" {style}>{text}</a>'


def _bar(share: int, width: int) -> str:
    done = f'<span style="{_DONE.format(part=share)}"></span>'
    return f'<span aria-hidden="true" style="{_BAR.format(width=width)}">{done}</span>'


def _everything(rows: Sequence[Row]) -> Row:
    return Row('', [item for row in rows for item in row.items])


def _done(items: Sequence[Item]) -> int:
    return sum(item.state == 'done' for item in items)
