"""Worlds with physics from drawings of text."""

from __future__ import annotations

import math

from labkit.errors import LabError, quoted
from labkit.sim.physics.mujoco_world import PhysicsWorld
from labkit.sim.physics.things import Crate, Ice, Ramp
from labkit.sim.world import Post, Wall, World

__all__ = ['drawn']

# Most characters of a drawing.
MOST = 10_000
# What a ramp rises to.
_RAMPS = {'>': 0.0, '^': math.pi / 2, '<': math.pi, 'v': -math.pi / 2}


def drawn(text: str, *, cell: float = 0.5) -> PhysicsWorld:
    """Return the world that a text draws, a square for each character.

    `#` is a wall, which joins its neighbours, `o` a post, `c` a crate, `~` ice, and `>`, `^`, `<`
    and `v` are ramps that rise in that direction. `.` and blanks are floor, and so is `@`, which
    is the origin, x to the right and y up; without it the origin is the middle of the drawing.

    Args:
        text: The drawing.
        cell: Size of a square, m.

    Raises:
        LabError: It has other characters, is too large, or a number makes no sense.
    """
    rows = text.strip('\n').splitlines()
    if not 0 < cell < math.inf or len(text) > MOST:
        raise LabError(
            f'A drawing has squares of some size, and up to {MOST} characters; this has squares '
            f'of {cell!r} m, and {len(text)} characters.'
        )
    cells = {(x, -y): sign for y, row in enumerate(rows) for x, sign in enumerate(row)}
    home = next((place for place, sign in cells.items() if sign == '@'), None)
    width = max(map(len, rows), default=0)
    middle = home or ((width - 1) / 2, -(len(rows) - 1) / 2)
    walls: list[Wall] = []
    posts, crates, ice, ramps = [], [], [], []
    for (column, row), sign in cells.items():
        x, y = (column - middle[0]) * cell, (row - middle[1]) * cell
        if sign == '#':
            walls += _walls(cells, column, row, x, y, cell)
        elif sign == 'o':
            posts.append(Post(x, y, cell / 4))
        elif sign == 'c':
            crates.append(Crate(x, y, size=min(0.2, 0.8 * cell)))
        elif sign == '~':
            ice.append(Ice(x, y, cell, cell))
        elif sign in _RAMPS:
            yaw = _RAMPS[sign]
            start = x - cell / 2 * math.cos(yaw), y - cell / 2 * math.sin(yaw)
            ramps.append(Ramp(*start, yaw, cell, cell, cell / 6))
        elif sign not in '. @':
            raise LabError(
                f'A drawing has # o c ~ > ^ < v @ . and blanks, and this has {quoted(sign)} in '
                f'line {1 - row}.'
            )
    return PhysicsWorld(World(walls, posts), crates=crates, ice=ice, ramps=ramps)


def _walls(
    cells: dict[tuple[int, int], str], column: int, row: int, x: float, y: float, cell: float
) -> list[Wall]:
    """Return the walls from a square to its neighbours on the right and above."""
    found = [
        Wall(x, y, x + dx * cell, y + dy * cell)
        for dx, dy in ((1, 0), (0, 1))
        if cells.get((column + dx, row + dy)) == '#'
    ]
    beside = ((1, 0), (0, 1), (-1, 0), (0, -1))
    if not any(cells.get((column + dx, row + dy)) == '#' for dx, dy in beside):
        # One that stands alone.
        found.append(Wall(x - cell / 2, y, x + cell / 2, y))
    return found
