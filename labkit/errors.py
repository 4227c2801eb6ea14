"""Errors for people: what was expected, what was seen, what to do next."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence

__all__ = [
    'LabError',
    'LabTimeout',
    'SetupError',
    'cell_name',
    'did_you_mean',
    'first_few',
    'nearest',
    'printable',
    'quoted',
]

# Width of a message in a notebook: what fits on a projector.
WIDTH = 88
# Most characters of a quoted value: two lines of that.
MOST_QUOTED = 2 * WIDTH


class LabError(Exception):
    """Report something that a learner can fix.

    In a notebook it is shown without a traceback: the line of the cell that led to it, then the
    message. In a script it is an ordinary exception.

    Args:
        message: What was expected and what was seen, values shown with `!r`.
        todo: What to do next, in one or more sentences. Shown on a separate line.

    Attributes:
        end: How it has ended a spin, in sentences; '' if it has ended none. Shown last.
    """

    end = ''

    def __init__(self, message: str, *, todo: str = '') -> None:
        super().__init__(f'{message}\n{todo}' if todo else message)
        self.message = message
        self.todo = todo

    def _render_traceback_(self) -> list[str]:
        """Return the lines that IPython shows instead of a traceback."""
        place = _learner_line(self)
        text = f'{self.shown_name}: {self}' + f'\n{self.end}' * bool(self.end)
        return [place] * bool(place) + _wrapped(text)

    @property
    def shown_name(self) -> str:
        """The name under which a notebook shows it: subclasses are for internal use."""
        return next(c.__name__ for c in type(self).__mro__ if c.__module__ == __name__)


def _wrapped(text: str) -> list[str]:
    """Return the lines of a text, wrapped between words; JupyterLab would break words."""
    import textwrap

    wrap = textwrap.TextWrapper(WIDTH, break_long_words=False, break_on_hyphens=False)
    return [part for line in text.splitlines() for part in wrap.wrap(line) or ['']]


class LabTimeout(LabError, TimeoutError):
    """Report that something awaited did not happen within `timeout_sec`."""


class SetupError(LabError):
    """Report that this machine, or its environment, can't run the course.

    The command line shows only the message and ends with exit code 2.
    """


def _learner_line(error: BaseException) -> str:
    """Return the line of the learner's code that led to an error, '' if unknown."""
    # Called by IPython, so IPython is there.
    import linecache

    place = ''
    traceback = error.__traceback__
    while traceback is not None:
        code = traceback.tb_frame.f_code
        cell = cell_name(code.co_filename)
        if cell:
            text = linecache.getline(code.co_filename, traceback.tb_lineno).strip()
            place = f'{cell}, line {traceback.tb_lineno}: {text}'
        traceback = traceback.tb_next
    return place


def cell_name(filename: str) -> str:
    """Return the notebook cell of a code object's file name.

    Args:
        filename: `co_filename` of a code object.

    Returns:
        `'Cell In[3]'`, or `''` if the file is not a cell of the running notebook. IPython before
        8.0 does not tell the number: then it is `'Cell'`.
    """
    ipython = sys.modules.get('IPython')
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is None:
        return ''
    if not hasattr(shell.compile, 'format_code_name'):
        return 'Cell' if f'{os.sep}ipykernel_{os.getpid()}{os.sep}' in filename else ''
    data = shell.compile.format_code_name(filename)
    return f'{data[0]} {data[1]}' if data is not None else ''


def nearest(name: str, names: Iterable[str]) -> str:
    """Return the one of `names` that was most likely meant, '' if none is similar.

    Case and underscores are ignored, and names with the same last part are similar:
    `/robot/odom` and `/odom`.
    """
    import difflib

    known = list(names)
    last = _plain(name)
    for other in known:
        if last and _plain(other) == last:
            return other
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.7)
    return near[0] if near else ''


def first_few(names: Sequence[str]) -> str:
    """Return up to three names, and how many more there are."""
    shown = ', '.join(names[:3])
    return f'{shown} and {len(names) - 3} more' if len(names) > 3 else shown


def did_you_mean(name: str, names: Iterable[str], otherwise: str = '') -> str:
    """Return the question whether the nearest name was meant; `otherwise` if none is similar."""
    near = nearest(name, names)
    return f'Did you mean {near!r}?' if near else otherwise


def quoted(value: object) -> str:
    """Return a value as it is written in Python, its middle left out if that is long."""
    try:
        text = repr(value)
    except Exception:  # of somebody's own class, or nested too deep
        return f'<{type(value).__name__}>'
    half = MOST_QUOTED // 2
    return text if len(text) <= MOST_QUOTED else f'{text[:half]} ... {text[-half:]}'


def printable(text: str) -> str:
    """Return text with `?` for what could move a terminal's cursor, end a line, or is no text."""
    return ''.join(char if char.isprintable() else '?' for char in text)


def _plain(name: str) -> str:
    """Return the last part of a name, without case and underscores."""
    return name.rsplit('/', 1)[-1].lower().replace('_', '')
