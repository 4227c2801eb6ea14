"""A still picture in the colours of the page: JupyterLab shows one as it is, whatever the theme.

An SVG that is part of the page's HTML knows the page's variables, one that is shown as a picture
does not. A page that does not trust a notebook takes drawings out of its HTML; for such a page,
the picture as it is stands beside the drawing.
"""

from __future__ import annotations

import re
from base64 import b64encode
from html import escape

__all__ = ['as_source', 'picture', 'themed']

# Grey, black and white of our own drawings and of matplotlib's, and what each is in a page.
_THEME = {
    '#ffffff': 'var(--jp-layout-color0, #ffffff)',
    '#000000': 'var(--jp-content-font-color1, #000000)',
    '#37474f': 'var(--jp-content-font-color1, #37474f)',
    '#424242': 'var(--jp-content-font-color1, #424242)',
    '#616161': 'var(--jp-content-font-color2, #616161)',
    '#9e9e9e': 'var(--jp-border-color0, #9e9e9e)',
    '#e0e0e0': 'var(--jp-border-color2, #e0e0e0)',
}
_STYLE = 'max-width: 100%; height: auto'
_TAG = re.compile(r'<[a-z][^<>]*>')
_PAINT = re.compile(r' (fill|stroke)="(#[0-9a-f]{6})"')
_COLOUR = re.compile('#[0-9a-f]{6}')


def themed(drawing: str, words: str, source: str) -> str:
    """Return a drawing as HTML that follows the page's theme.

    Args:
        drawing: An SVG picture; an element's colours are all attributes, or all in its style.
        words: Its text alternative.
        source: The same as a picture, see `as_source`, for pages that do not trust the notebook.
    """
    drawing = drawing[drawing.index('<svg') :]
    drawing = drawing.replace('<svg', f'<svg aria-hidden="true" style="{_STYLE}"', 1)
    drawing = _TAG.sub(_with_style, drawing)
    drawing = _COLOUR.sub(lambda found: _THEME.get(found[0], found[0]), drawing)
    label = escape(words)
    return (
        f'<div role="img" aria-label="{label}">{drawing}</div>'
        f'<template>{picture(words, source)}</template>'
    )


def _with_style(tag: re.Match[str]) -> str:
    """Return a tag with its colours in a style: an attribute can not hold a variable."""
    paints = _PAINT.findall(tag[0])
    if not paints or 'style=' in tag[0]:
        return tag[0]
    rules = '; '.join(f'{name}: {colour}' for name, colour in paints)
    bare = _PAINT.sub('', tag[0])
    end = '/>' if bare.endswith('/>') else '>'
    return f'{bare.removesuffix(end)} style="{rules}"{end}'


def picture(words: str, source: str) -> str:
    """Return a picture as HTML.

    Args:
        words: Its text alternative.
        source: What it shows, see `as_source`.
    """
    return f'<img alt="{escape(words)}" src="{source}" style="{_STYLE}">'


def as_source(kind: str, data: bytes) -> str:
    """Return a file, such as one of the kind `image/png`, as the source of a picture."""
    return f'data:{kind};base64,{b64encode(data).decode()}'
