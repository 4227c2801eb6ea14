"""The card of a solution: its code in the colours of JupyterLab's editor, and a button to copy it.

Elsewhere the code has the page's own colour.
"""

from __future__ import annotations

import html
from pathlib import Path

from labkit.views.card import CODE_STYLE, Card

__all__ = ['SolutionCard']

# Kinds of words, as Pygments names them, and the variable of JupyterLab that has their colour.
# The longest name that fits counts.
_COLOURS = {
    'Token.Comment': 'comment',
    'Token.Keyword': 'keyword',
    'Token.Literal.Number': 'number',
    'Token.Literal.String': 'string',
    'Token.Name.Builtin': 'builtin',
    'Token.Name.Builtin.Pseudo': 'variable-2',
    'Token.Name.Class': 'def',
    'Token.Name.Decorator': 'meta',
    'Token.Name.Function': 'def',
    'Token.Operator': 'operator',
    'Token.Operator.Word': 'keyword',
}
_BOLD = ('keyword', 'operator')


class SolutionCard(Card):
    """A card whose code is Python, to be read and copied. In text it is a card as any other."""

    def _repr_html_(self) -> str:
        """Return the card as HTML; everything in it is escaped."""
        card = Card(self.tone, self.word, self.title, self.text, self.rows)
        start, _, _ = card._repr_html_().rpartition('</div>')
        script = (Path(__file__).parent / 'copy.js').read_text(encoding='utf-8')
        # Reachable by keyboard, because a wide one scrolls.
        code = f'<pre tabindex="0" style="{CODE_STYLE}">{_highlighted(self.code.rstrip())}</pre>'
        return f'{start}<div>{code}<script>{script}</script></div>\n</div>'


def _highlighted(code: str) -> str:
    """Return Python code as HTML, with the colours of JupyterLab's theme."""
    from pygments.lexers import PythonLexer

    return ''.join(
        _coloured(html.escape(text), str(kind))
        for kind, text in PythonLexer(stripnl=False, ensurenl=False).get_tokens(code)
    )


def _coloured(text: str, kind: str) -> str:
    while kind and kind not in _COLOURS:
        kind = kind.rpartition('.')[0]
    if not kind:
        return text
    name = _COLOURS[kind]
    weight = ';font-weight:bold' * (name in _BOLD)
    return (
        f'<span style="color:var(--jp-mirror-editor-{name}-color, inherit){weight}">{text}</span>'
    )
