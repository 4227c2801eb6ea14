"""The command `labkit classroom`: a class as text, or as a table for marking."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from datetime import datetime, timezone

from labkit.teaching.class_folder import ClassFolder, chosen_folder
from labkit.teaching.counting import count
from labkit.teaching.tables import gradebook, table
from labkit.views.class_board import text_form

__all__ = ['main']


def main(argv: Sequence[str] | None = None) -> int:
    """Show a class on the command line, or write it as a table.

    Args:
        argv: Arguments after `labkit classroom`.

    Returns:
        Exit code.

    Raises:
        LabError: There is no such folder.
    """
    parser = argparse.ArgumentParser(
        prog='labkit classroom', description='Show what the learners of a class share.'
    )
    parser.add_argument(
        'folder', nargs='?', help='that of the class; LABKIT_CLASS_FOLDER if not given'
    )
    parser.add_argument('--names', action='store_true', help='tell who is who')
    tables = parser.add_mutually_exclusive_group()
    tables.add_argument(
        '--csv', action='store_true', help='write all, one line a learner and exercise or question'
    )
    tables.add_argument(
        '--gradebook',
        action='store_true',
        help="write percents, one line a learner, for Moodle's grade import and the like",
    )
    options = parser.parse_args(argv)
    reading, now = ClassFolder(chosen_folder(options.folder)).read(), datetime.now(timezone.utc)
    if not (options.csv or options.gradebook):
        print(text_form(count(reading, now), names=options.names))
        return 0
    if reading.note:
        print(reading.note, file=sys.stderr)
    for learner in reading.learners:
        if learner.sheet is None:
            print(f'{learner.name}: can not be used: {learner.trouble}', file=sys.stderr)
    text = table(reading.learners, now) if options.csv else gradebook(reading.learners)
    print(text, end='')
    return 0
