"""The page on which JupyterLab opens once a learner has begun: all lessons, and where one is.

It is a Markdown file in the learner's folder, which JupyterLab shows without a kernel. It is
written when JupyterLab starts and whenever something is noted in the progress file.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from labkit.exercises.attempts import progress_store
from labkit.exercises.lesson import all_lessons
from labkit.exercises.standing import onward, row_of
from labkit.files import write_atomically
from labkit.views.progress_picture import Item, Row, percent, sign

__all__ = ['follow_progress', 'main', 'page', 'write_home']

# Where the page is, for the kernels that `labkit lab` starts.
VARIABLE = 'LABKIT_HOME_PAGE'
# A file without it is somebody else's.
MARK = '<!-- labkit writes this page: what you change here is lost. -->\n'
_PAGE = """{mark}
# Learn ROS 2

**{share} %** done: {counts}.

{go_on}

| lesson | you learn | exercises | quiz | done |
|:--|:--|:--|:--|--:|
{lines}

✔ done, … tried, ○ open.

This is how it was on {time}. The page is written anew when JupyterLab starts, and whenever you
solve something: close it and open it again to see the newest. `lab.progress()` in a cell always
shows the newest.
"""


def write_home(path: Path) -> None:
    """Write the page, unless a file of the learner's own is there.

    Args:
        path: The file.

    Raises:
        OSError: It can't be written.
    """
    if os.path.lexists(path):
        with path.open(encoding='utf-8', errors='replace') as file:
            if file.readline() != MARK:
                return
    data, _ = progress_store.store.read()
    rows = [row_of(lesson, data) for lesson in all_lessons()]
    write_atomically(path, page(rows, onward(data), datetime.now()).encode())


def page(rows: Sequence[Row], places: Sequence[tuple[str, str]], now: datetime) -> str:
    """Return the page as Markdown.

    Args:
        rows: The lessons.
        places: Where to go on: pairs of a text and where it is.
        now: The moment at which it is so.
    """
    everything = Row('', [item for row in rows for item in row.items])
    links = [f'Go on: **[{text}]({href})**' for text, href in places]
    return _PAGE.format(
        mark=MARK,
        share=percent(everything.items),
        counts=everything.counts(),
        go_on=''.join(links) or 'You have solved all of it.',
        lines='\n'.join(map(_line, rows)),
        time=now.strftime('%d %B %Y at %H:%M'),
    )


def main(argv: Sequence[str]) -> int:
    """Write the page, for `labkit lab`.

    Args:
        argv: The file.

    Returns:
        Exit code.
    """
    write_home(Path(argv[0]))
    return 0


def follow_progress() -> None:
    """Write the page anew from now on, in a notebook that `labkit lab` has opened."""
    path = os.environ.get(VARIABLE)
    if path and _refresh not in progress_store.after_change:
        progress_store.after_change.append(_refresh)


def _refresh() -> None:
    # What can not be written was said of the progress file, or is no matter of a check.
    with contextlib.suppress(OSError):
        write_home(Path(os.environ[VARIABLE]))


def _line(row: Row) -> str:
    questions = row.of_kind('question')
    done = sum(item.state == 'done' for item in questions)
    cells = [
        f'[{row.title}]({row.href})',
        row.teaches,
        ' &ensp;'.join(map(_mark, row.of_kind('exercise'))),
        f'{done}&nbsp;of&nbsp;{len(questions)}' if questions else '',
        f'{percent(row.items)}&nbsp;%',
    ]
    return f'| {" | ".join(cells)} |'


def _mark(item: Item) -> str:
    return f'{sign(item)}&nbsp;[{item.name}]({item.href})'


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
