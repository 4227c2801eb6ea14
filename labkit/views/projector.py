"""Larger type for a projector: `lab.projector()`.

The page puts a class on the notebook, and a style sheet enlarges the type. Everything labkit shows
is sized relative to the notebook, so the kernel need not change anything.
"""

from __future__ import annotations

import functools

import traitlets

from labkit import settings
from labkit.views.widget import PageWidget, page_files

__all__ = ['Projector', 'projector']


class Projector:
    """Whether the notebook has larger type (`on`); see `projector`."""

    def __init__(self, *, on: bool) -> None:
        self.on = on

    def __repr__(self) -> str:
        if self.on:
            return 'Projector mode is on. It ends with lab.projector(False).'
        return 'Projector mode is off.'

    def _repr_mimebundle_(self, **_: object) -> dict[str, object]:
        words: dict[str, object] = {'text/plain': repr(self)}
        if not settings.audience().live:
            return words
        page = _page()
        page.set_trait('on', self.on)
        page.set_trait('words', repr(self))
        shown, _ = page._repr_mimebundle_() or ({}, {})
        return {**shown, **words}


@functools.cache
def _page() -> PageWidget:
    """Return the kernel's one widget: all of its views show the same state."""
    script, style = page_files('projector')
    parts = {
        '_esm': script,
        '_css': style,
        'on': traitlets.Bool(False).tag(sync=True),
        'words': traitlets.Unicode().tag(sync=True),
    }
    page: PageWidget = type('ProjectorPage', (PageWidget,), parts)()
    return page


def projector(on: bool = True) -> Projector:
    """Give this notebook larger type: code, outputs, views and plots.

    It lasts until it is switched off, or the page is reloaded without the output of this cell.

    Args:
        on: Whether the type is larger; False for the usual size.

    Returns:
        The current mode, shown as a sentence.
    """
    return Projector(on=bool(on))
