"""Pictures of what was driven, under the cell of the check."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from labkit import settings
from labkit.lessons.turtlebot.drive import Drive
from labkit.views.arena_picture import Scene, row, two
from labkit.views.themed import as_source, themed

__all__ = ['observed']

# So many pictures fit next to each other in a cell.
ABREAST = 2


@contextmanager
def observed() -> Iterator[list[Drive]]:
    """Draw what was driven, whatever the verdict is: give a list to put the drives in."""
    drives: list[Drive] = []
    try:
        yield drives
    finally:
        # The robot stays where it came to, so that the arena shows the drive as well.
        driven = [drive for drive in drives if drive.poses]
        if driven:
            _show(driven)


def _show(drives: list[Drive]) -> None:
    """Draw drives, two next to each other, and tell them in words; in a script, in words only."""
    if not settings.in_kernel():
        print(*map(_words, drives), sep='\n')
        return
    for first in range(0, len(drives), ABREAST):
        _show_row(drives[first : first + ABREAST])


def _show_row(drives: list[Drive]) -> None:
    from IPython.display import display

    scenes = [
        Scene(
            pose=drive.end,
            trail=[pose[:2] for _, pose in drive.poses],
            scan=drive.walls,
            goals=drive.goals,
        )
        for drive in drives
    ]
    text = '\n'.join(map(_words, drives))
    drawing = row(scenes, text)
    forms = {'text/plain': text, 'image/svg+xml': drawing}
    if settings.audience().live:
        forms['text/html'] = themed(drawing, text, as_source('image/svg+xml', drawing.encode()))
    display(forms, raw=True)  # type: ignore[no-untyped-call]


def _words(drive: Drive) -> str:
    return (
        f'Drive from x = {two(drive.start.x)} m, y = {two(drive.start.y)} m '
        f'to x = {two(drive.end.x)} m, y = {two(drive.end.y)} m: '
        f'{two(drive.way())} m in {drive.duration:.1f} s, {len(drive.commands)} commands.'
    )
