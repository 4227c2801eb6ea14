"""Faults of this machine, this environment or this notebook, and how to fix them.

`lab.doctor()` in a cell and `python3 -m labkit doctor` in a terminal show the same table. Each
check is independent: one that fails, even unexpectedly, is a red line and does not stop the
others. Runs in any Python from 3.8 on, with or without ROS.
"""

from __future__ import annotations

import html
import re
import textwrap
from collections.abc import Callable
from dataclasses import dataclass

from labkit import settings
from labkit.checkup import packages, ros, system, variables
from labkit.checkup.found import TODO, Found
from labkit.errors import LabError

__all__ = ['Line', 'Report', 'doctor']

# Name of the line -> check, which returns what it saw, and raises if something is wrong.
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
        name: Subject of the check.
        ok: Whether it passed.
        seen: What was seen.
        todo: What to do, if it did not pass.
        lines: Both, fault by fault, if several can be found.
    """

    name: str
    ok: bool
    seen: str
    todo: str = ''
    lines: tuple[str, ...] = ()


class Report:
    """The doctor's table: text in a terminal, a table in a notebook.

    Args:
        lines: Its lines.
        brief: Whether to leave out what differs between healthy machines, for reproducible output.

    Attributes:
        ok: Whether all checks passed.
    """

    def __init__(self, lines: tuple[Line, ...], *, brief: bool = False) -> None:
        self.lines = lines
        self.ok = all(line.ok for line in lines)
        self._brief = brief

    def __repr__(self) -> str:
        width = max(len(line.name) for line in self.lines) + 2
        rows = []
        for line in self.lines:
            sign, word, _ = _MARKS[line.ok]
            start = f'{sign} {word:<7}{line.name:<{width}}'
            for text in self._texts(line):
                deeper = 2 * text.startswith(TODO)
                rows += textwrap.wrap(
                    text,
                    _WIDTH,
                    initial_indent=start,
                    subsequent_indent=' ' * (len(start) + deeper),
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
            texts = '<br>'.join(html.escape(text) for text in self._texts(line))
            # Of several faults, each is a paragraph, and the first one stands beside the name.
            texts = re.sub(f'(?<=<br>){TODO}.*?<br>', r'\g<0><br>', texts)
            top = ';vertical-align:top' * ('<br><br>' in texts)
            rows.append(
                f'<tr><td style="border-left:0.4em solid {colour};{_SHORT};font-weight:{weight}'
                f'{top}"><span aria-hidden="true">{sign}</span> {word}</td>'
                f'<th scope="row" style="{_SHORT}{top}">{html.escape(line.name)}</th>'
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
        if line.ok:
            return [''] if self._brief else [line.seen]
        return [*line.lines] or [line.seen, *([f'{TODO}{line.todo}'] if line.todo else [])]

    def _sum(self) -> str:
        wrong = sum(not line.ok for line in self.lines)
        if not wrong:
            return 'All is well.'
        words = 'is wrong.' if wrong == 1 else 'are wrong. Begin with the first of them.'
        return f'{wrong} of {len(self.lines)} lines {words}'


def doctor() -> Report:
    """Check this machine, this environment and this notebook.

    Returns:
        A report with `ok` and `lines`, shown as a table.
    """
    lines = tuple(_line(name, check) for name, check in _CHECKS)
    return Report(lines, brief=settings.audience().same_each_time)


def _line(name: str, check: Callable[[], str]) -> Line:
    try:
        return Line(name, True, check())
    except Found as error:
        return Line(name, False, error.message, error.todo, error.lines)
    except LabError as error:
        return Line(name, False, error.message, error.todo)
    except Exception as error:  # any: the other lines matter all the more
        return Line(name, False, f'This could not be looked at: {error!r}')
