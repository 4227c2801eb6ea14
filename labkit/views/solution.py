"""The card of a solution: highlighted like JupyterLab's editor, with a copy button."""

from __future__ import annotations

import html
from pathlib import Path

from labkit.views.card import CODE_STYLE, Card

__all__ = ['SolutionCard']

# Token types of Pygments, and the JupyterLab variable with their colour. The longest match counts.
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
    """A card with Python code to read and copy; as text, an ordinary card."""

    def _repr_html_(self) -> str:
        card = Card(self.tone, self.word, self.title, self.text, self.rows)
        start, _, _ = card._repr_html_().rpartition('</div>')
        script = (Path(__file__).parent / 'copy.js').read_text(encoding='utf-8')
        # Focusable, because a wide one scrolls.
        code = f'<pre tabindex="0" style="{CODE_STYLE}">{_highlighted(self.code.rstrip())}</pre>'
        return f'{start}<div>{code}<script>{script}</script></div>\n</div>'


def _highlighted(code: str) -> str:
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
