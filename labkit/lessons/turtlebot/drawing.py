"""Pictures of what was driven, under the cell of the check."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from labkit import settings
from labkit.exercises.figures import many
from labkit.lessons.turtlebot.drive import Drive, Point
from labkit.sim.kinematics import Pose
from labkit.views.arena_picture import Scene, row, two
from labkit.views.themed import as_source, themed

__all__ = ['observed']

# So many pictures fit next to each other in a cell.
ABREAST = 2
# What is told of a drive is so, if that is what its task is about.
FRAME = 'seen from the start'


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

    scenes = list(map(_scene, drives))
    text = '\n'.join(map(_words, drives))
    drawing = row(scenes, text)
    forms = {'text/plain': text, 'image/svg+xml': drawing}
    if settings.audience().live:
        forms['text/html'] = themed(drawing, text, as_source('image/svg+xml', drawing.encode()))
    display(forms, raw=True)  # type: ignore[no-untyped-call]


def _scene(drive: Drive) -> Scene:
    """Return a drive as a scene, in the frame in which the verdict tells of it."""

    def told(point: Point) -> Point:
        return drive.told(Pose(*point, 0.0))[:2]

    return Scene(
        pose=drive.told(drive.end),
        trail=[drive.told(pose)[:2] for _, pose in drive.came],
        scan=[None if end is None else told(end) for end in drive.walls],
        goals=drive.goals,
        frame=FRAME if drive.from_start else '',
    )


def _words(drive: Drive) -> str:
    start, end = drive.told(drive.start), drive.told(drive.end)
    frame = f', {FRAME}:' if drive.from_start else ''
    return (
        f'Drive{frame} from x = {two(start.x)} m, y = {two(start.y)} m '
        f'to x = {two(end.x)} m, y = {two(end.y)} m: '
        f'{two(drive.way())} m in {drive.duration:.1f} s, {many(len(drive.commands), "command")}.'
    )
