"""Still pictures in the colours of the page: JupyterLab shows images the same in any theme.

An inline SVG can use the page's variables, an image can't: one of a drawing is inverted on a dark
page. A page that does not trust a notebook strips inline drawings; for such a page, the plain
image stands beside the drawing.
"""

from __future__ import annotations

import re
from base64 import b64encode
from html import escape

__all__ = ['as_source', 'picture', 'themed']

# Greys, black and white of our drawings and matplotlib's, and their variables in a page.
_THEME = {
    '#ffffff': 'var(--jp-layout-color0, #ffffff)',
    '#000000': 'var(--jp-content-font-color1, #000000)',
    '#37474f': 'var(--jp-content-font-color1, #37474f)',
    '#424242': 'var(--jp-content-font-color1, #424242)',
    '#616161': 'var(--jp-content-font-color2, #616161)',
    '#9e9e9e': 'var(--jp-border-color0, #9e9e9e)',
    '#e0e0e0': 'var(--jp-border-color2, #e0e0e0)',
}
# White becomes nearly black, black light, and colours keep their hue. On paper nothing is dark.
_NIGHT = (
    '<style>@media screen { [data-jp-theme-light="false"] .labkit-drawing '
    '{ filter: invert(0.93) hue-rotate(180deg) } }</style>'
)
_STYLE = 'max-width: 100%; height: auto'
_TAG = re.compile(r'<[a-z][^<>]*>')
_PAINT = re.compile(r' (fill|stroke)="(#[0-9a-f]{6})"')
_COLOUR = re.compile('#[0-9a-f]{6}')


def themed(drawing: str, words: str, source: str) -> str:
    """Return a drawing as HTML that follows the page's theme.

    Args:
        drawing: An SVG; an element's colours are all attributes, or all in its style.
        words: Its text alternative.
        source: The same as an image, see `as_source`, for pages that do not trust the notebook.
    """
    drawing = drawing[drawing.index('<svg') :]
    # What has no colour is black: matplotlib writes all of its text so.
    style = f'{_STYLE}; fill: #000000'
    drawing = drawing.replace('<svg', f'<svg aria-hidden="true" style="{style}"', 1)
    drawing = _TAG.sub(_with_style, drawing)
    drawing = _COLOUR.sub(lambda found: _THEME.get(found[0], found[0]), drawing)
    label = escape(words)
    return (
        f'<div role="img" aria-label="{label}">{drawing}</div>'
        f'<template>{picture(words, source)}</template>'
    )


def _with_style(tag: re.Match[str]) -> str:
    """Return a tag with its colours in a style: an attribute can't hold a variable."""
    paints = _PAINT.findall(tag[0])
    if not paints or 'style=' in tag[0]:
        return tag[0]
    rules = '; '.join(f'{name}: {colour}' for name, colour in paints)
    bare = _PAINT.sub('', tag[0])
    end = '/>' if bare.endswith('/>') else '>'
    return f'{bare.removesuffix(end)} style="{rules}"{end}'


def picture(words: str, source: str) -> str:
    """Return an image as HTML, with a text alternative; see `as_source`.

    A drawing, which is an SVG, is dark on a dark page. A photograph stays as it is.
    """
    if source.startswith('data:image/svg+xml'):
        night, mark = _NIGHT, ' class="labkit-drawing"'
    else:
        night, mark = '', ''
    return f'{night}<img{mark} alt="{escape(words)}" src="{source}" style="{_STYLE}">'


def as_source(kind: str, data: bytes | str) -> str:
    """Return a file of a kind such as `image/png` as a data URL.

    Args:
        kind: Its type.
        data: Its bytes, or its text as outputs hold it: an SVG, or something else in base64.
    """
    if isinstance(data, str) and kind == 'image/svg+xml':
        data = data.encode()
    text = data if isinstance(data, str) else b64encode(data).decode()
    return f'data:{kind};base64,{text}'
