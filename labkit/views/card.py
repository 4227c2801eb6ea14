"""Cards with the results of exercises and quizzes: HTML in a notebook, plain text elsewhere.

A card never relies on colour: its tone is also a sign and a word. It uses JupyterLab's theme
colours; elsewhere it inherits the page's.
"""

from __future__ import annotations

import html
import re
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ['CODE_STYLE', 'Card', 'rich']

# tone -> (sign, colour of the edge)
_TONES = {
    'good': ('✔', 'var(--jp-success-color1, #2e7d32)'),
    'bad': ('✘', 'var(--jp-error-color1, #c62828)'),
    'warn': ('⚠', 'var(--jp-warn-color1, #ef6c00)'),
    'quiet': ('○', 'var(--jp-border-color1, #9e9e9e)'),
    'info': ('ℹ', 'var(--jp-info-color1, #0277bd)'),
}
_WIDTH = 92
_EDGE = (
    'border-left:0.4em solid {colour};padding:0.5em 1em;margin:0.3em 0;max-width:60em;'
    'color:var(--jp-content-font-color1, inherit)'
)
_ROWS = 'display:grid;grid-template-columns:max-content 1fr;gap:0.2em 1em;margin:0.4em 0 0'
# JupyterLab styles such lists itself.
_LABEL = 'font-weight:bold;float:none;width:auto;white-space:nowrap'
# Keep spaces: one too many may be the mistake.
_TEXT = 'margin:0;padding:0;overflow-wrap:anywhere;white-space:break-spaces'
# What to do next is what a learner looks for.
_NEXT = 'font-size:1.2em;font-weight:600;line-height:1.4'
CODE_STYLE = (
    'margin:0.5em 0 0;padding:0.5em;overflow-x:auto;white-space:pre;'
    'border:1px solid var(--jp-border-color2, #9e9e9e)'
)


@dataclass(frozen=True, repr=False)
class Card:
    """A message: text in a terminal, a box in a notebook.

    Attributes:
        tone: `'good'`, `'bad'`, `'warn'`, `'quiet'` or `'info'`.
        word: The tone as a word, such as `'PASS'`.
        title: The subject, such as the name of an exercise.
        text: Sentences under the title. Words in backticks are shown as code.
        rows: Pairs of label and text; pairs without text are left out.
        code: Lines shown verbatim: a solution, a traceback.
    """

    tone: str
    word: str
    title: str
    text: str = ''
    rows: Sequence[tuple[str, str]] = ()
    code: str = ''

    def __repr__(self) -> str:
        lines = [f'{self.word}: {self.title}' if self.title else self.word]
        for paragraph in filter(None, self.text.splitlines()):
            lines += textwrap.wrap(paragraph, _WIDTH, initial_indent='  ', subsequent_indent='  ')
        rows = [row for row in self.rows if row[1]]
        width = max((len(label) for label, _ in rows), default=0) + 2
        for label, text in rows:
            # Keep line breaks, so that a list stays a list.
            start = f'  {label + ":":<{width}}'
            for line in text.splitlines():
                lines += textwrap.wrap(
                    line, _WIDTH, initial_indent=start, subsequent_indent=' ' * len(start)
                ) or ['']
                start = ' ' * len(start)
        if self.code:
            lines.append(textwrap.indent(self.code.rstrip(), '    '))
        return '\n'.join(lines)

    def _repr_html_(self) -> str:
        """Return the card as HTML; everything in it is escaped."""
        sign, colour = _TONES[self.tone]
        title = f': {rich(self.title)}' if self.title else ''
        parts = [
            f'<div role="status" style="{_EDGE.format(colour=colour)}">',
            f'<div><span aria-hidden="true">{sign}</span> '
            f'<strong>{html.escape(self.word)}</strong>{title}</div>',
        ]
        parts += [f'<div>{rich(line)}</div>' for line in self.text.splitlines() if line]
        rows = [
            f'<dt style="{_LABEL}{size}">{html.escape(label)}</dt>'
            f'<dd style="{_TEXT}{size}">{rich(text)}</dd>'
            for label, text in self.rows
            if text
            for size in [f';{_NEXT}' if label == 'Next' else '']
        ]
        if rows:
            parts.append(f'<dl style="{_ROWS}">{"".join(rows)}</dl>')
        if self.code:
            # Focusable, because a wide one scrolls.
            parts.append(
                f'<pre tabindex="0" style="{CODE_STYLE}">{html.escape(self.code.rstrip())}</pre>'
            )
        return '\n'.join([*parts, '</div>'])


def rich(text: str) -> str:
    """Return text as HTML: escaped, with `code` in backticks and a line break per newline."""
    escaped = html.escape(text)
    marked = re.sub(r'`([^`\n]+)`', r'<code>\1</code>', escaped)
    return marked.replace('\n', '<br>')
