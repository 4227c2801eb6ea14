"""The page on which JupyterLab opens once a learner has begun: all lessons with their progress.

It is a Markdown file in the learner's folder, which JupyterLab shows without a kernel. It is
written when JupyterLab starts and whenever the progress file changes.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from labkit.exercises.found_lessons import all_lessons
from labkit.exercises.lesson_progress import onward, row_of
from labkit.exercises.record.progress_store import progress_store
from labkit.files import read_limited, write_atomically
from labkit.views.course_map import markdown_map
from labkit.views.progress_picture import Item, Row, percent, sign

__all__ = ['follow_progress', 'main', 'page', 'write_home']

# Environment variable with the path of the page, for the kernels that `labkit lab` starts.
VARIABLE = 'LABKIT_HOME_PAGE'
# A file without this first line is the learner's own.
MARK = '<!-- labkit writes this page: what you change here is lost. -->\n'
_PAGE = """{mark}
# Learn ROS 2

{map}

**{share} %** of the exercises: {counts}.

{go_on}

| lesson | you learn | exercises | quiz | done |
|:--|:--|:--|:--|--:|
{lines}

✔ done, … tried, ○ open.

A notebook is broken, or gone? `labkit restore` in a terminal gets it back as you last saved it.

This is how it was on {time}. The page is written anew when JupyterLab starts, and whenever you
solve something: close it and open it again to see the newest. `lab.progress()` in a cell always
shows the newest.
"""


def write_home(path: Path) -> None:
    """Write the page, unless the file is the learner's own.

    Raises:
        OSError: It can't be written.
    """
    if os.path.lexists(path) and not _is_ours(path):
        return
    data, _ = progress_store.store.read()
    rows = [row_of(lesson, data) for lesson in all_lessons()]
    write_atomically(path, page(rows, onward(data, all_lessons()), datetime.now()).encode())


def page(rows: Sequence[Row], places: Sequence[tuple[str, str]], now: datetime) -> str:
    """Return the page as Markdown.

    Args:
        rows: The lessons.
        places: Places to continue, as pairs of a text and a link.
        now: The time to show.
    """
    everything = Row('', [item for row in rows for item in row.items])
    links = [f'Go on: **[{text}]({href})**' for text, href in places]
    here = places[0][1].partition('#')[0] if places else ''
    return _PAGE.format(
        mark=MARK,
        map=markdown_map(rows, here),
        share=percent(everything.items),
        counts=everything.counts(),
        go_on=''.join(links) or 'You have solved all of it.',
        lines='\n'.join(map(_line, rows)),
        time=now.strftime('%d %B %Y at %H:%M'),
    )


def main(argv: Sequence[str]) -> int:
    """Write the page to the file that `labkit lab` names; return the exit code."""
    write_home(Path(argv[0]))
    return 0


def follow_progress() -> None:
    """Rewrite the page after each change, in a notebook that `labkit lab` has opened."""
    path = os.environ.get(VARIABLE)
    if path and _refresh not in progress_store.after_change:
        progress_store.after_change.append(_refresh)


def _refresh() -> None:
    # A check has reported a failing progress file already; the page does not concern it.
    with contextlib.suppress(OSError):
        write_home(Path(os.environ[VARIABLE]))


def _is_ours(path: Path) -> bool:
    try:
        return read_limited(path).startswith(MARK.encode())
    except OSError:
        return False


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
