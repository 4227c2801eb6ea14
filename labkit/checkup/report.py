"""What is wrong with this machine, this environment, this notebook, and what to do about it.

`lab.doctor()` in a cell and `python3 -m labkit doctor` in a terminal show the same table. Each
check stands for itself: one that fails, or that meets what nobody thought of, is a red line and
not the end of the others. Runs in any Python from 3.8 on, with or without ROS.
"""

from __future__ import annotations

import html
import textwrap
from collections.abc import Callable
from dataclasses import dataclass

from labkit import settings
from labkit.checkup import packages, ros, system, variables
from labkit.errors import LabError

__all__ = ['Line', 'Report', 'doctor']

# What the line is called -> what looks. A check returns what it saw, and raises if it is wrong.
_CHECKS: tuple[tuple[str, Callable[[], str]], ...] = (
    ('Python', packages.python),
    ('ROS 2 packages', packages.ros_packages),
    ('Middleware', ros.middleware),
    ('Network', system.network),
    ('Shared memory', system.shared_memory),
    ('Domain', ros.domain),
    ('Variables', variables.variables),
    ('Nodes', ros.nodes),
    ('Topics', ros.topics),
    ('Callbacks', ros.callbacks),
    ('JupyterLab', packages.jupyter),
    ('Disk', system.disk),
    ('Compiler', system.compiler),
)
_WIDTH = 98
_SHORT = 'text-align:left;white-space:nowrap'
# ok -> sign, word, colour of the edge
_MARKS = {
    True: ('✔', 'good', 'var(--jp-success-color1, #2e7d32)'),
    False: ('✘', 'wrong', 'var(--jp-error-color1, #c62828)'),
}


@dataclass(frozen=True)
class Line:
    """One line of the table.

    Attributes:
        name: What was looked at.
        ok: Whether it is as it should be.
        seen: What was seen.
        todo: What to do, if it is not.
    """

    name: str
    ok: bool
    seen: str
    todo: str = ''


class Report:
    """The doctor's table: text in a terminal, a table in a notebook.

    Args:
        lines: Its lines.
        brief: Leave out what differs between healthy machines, so that the report of one is the
            same as that of another.

    Attributes:
        ok: Whether all lines are good.
    """

    def __init__(self, lines: tuple[Line, ...], *, brief: bool = False) -> None:
        self.lines = lines
        self.ok = all(line.ok for line in lines)
        self._brief = brief

    def __repr__(self) -> str:
        """Return the table as text."""
        width = max(len(line.name) for line in self.lines) + 2
        rows = []
        for line in self.lines:
            sign, word, _ = _MARKS[line.ok]
            start = f'{sign} {word:<7}{line.name:<{width}}'
            for number, text in enumerate(self._texts(line)):
                arrow = '→ ' if number else ''
                rows += textwrap.wrap(
                    text,
                    _WIDTH,
                    initial_indent=start + arrow,
                    subsequent_indent=' ' * len(start + arrow),
                    break_long_words=False,
                    break_on_hyphens=False,
                ) or [start.rstrip()]
                start = ' ' * len(start)
        return '\n'.join([*rows, '', self._sum()])

    def _repr_html_(self) -> str:
        """Return the table as HTML; everything in it is escaped."""
        rows = []
        for line in self.lines:
            sign, word, colour = _MARKS[line.ok]
            weight = 'normal' if line.ok else 'bold'
            texts = '<br>→ '.join(html.escape(text) for text in self._texts(line))
            rows.append(
                f'<tr><td style="border-left:0.4em solid {colour};{_SHORT};font-weight:{weight}">'
                f'<span aria-hidden="true">{sign}</span> {word}</td>'
                f'<th scope="row" style="{_SHORT}">{html.escape(line.name)}</th>'
                f'<td style="text-align:left;overflow-wrap:anywhere">{texts}</td></tr>'
            )
        return '\n'.join(
            [
                '<table style="color:var(--jp-content-font-color1, inherit)">',
                f'<caption style="caption-side:bottom;text-align:left">{self._sum()}</caption>',
                *rows,
                '</table>',
            ]
        )

    def _texts(self, line: Line) -> list[str]:
        if not line.ok:
            return [line.seen, *([line.todo] if line.todo else [])]
        return [''] if self._brief else [line.seen]

    def _sum(self) -> str:
        wrong = sum(not line.ok for line in self.lines)
        if not wrong:
            return 'All is well.'
        return f'{wrong} of {len(self.lines)} lines {"is" if wrong == 1 else "are"} wrong.'


def doctor() -> Report:
    """Look at this machine, this environment and this notebook.

    Returns:
        A report with `ok` and `lines`. It shows itself as a table.
    """
    lines = tuple(_line(name, check) for name, check in _CHECKS)
    return Report(lines, brief=settings.audience().same_each_time)


def _line(name: str, check: Callable[[], str]) -> Line:
    try:
        return Line(name, True, check())
    except LabError as error:
        return Line(name, False, error.message, error.todo)
    except Exception as error:  # whatever it is: the other lines are wanted all the more
        return Line(name, False, f'This could not be looked at: {error!r}')
