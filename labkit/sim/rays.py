"""How far it is to walls and posts along many rays at once, by NumPy: pure geometry in metres.

The laser scanner looks along 360 rays; a Python loop over them would take milliseconds.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ['TOUCH', 'Convex', 'see_posts', 'see_walls']

# Closer than this is the same place, m: far below what can be seen and far above rounding.
TOUCH = 1e-9
Numbers = NDArray[np.float64]


class Convex:
    """The sides of a convex room, as lines that are never seen from behind.

    From inside a ray leaves the room through the first line that it reaches, so it does not have
    to be asked where the sides end.

    Args:
        corners: The corners, one after the other, at least three, m.
    """

    def __init__(self, corners: Sequence[tuple[float, float]]) -> None:
        points = np.array(corners, dtype=float)
        along = np.roll(points, -1, axis=0) - points
        outwards = np.column_stack((along[:, 1], -along[:, 0]))
        outwards /= np.hypot(*along.T)[:, None]
        offsets = np.sum(outwards * points, axis=1)
        # Corners may go round either way; the middle is inside.
        sign = 1.0 if np.all(offsets >= outwards @ points.mean(axis=0)) else -1.0
        self._outwards: Numbers = sign * outwards
        self._offsets: Numbers = sign * offsets

    def see(self, eye: Numbers, rays: Numbers) -> Numbers | None:
        """Return for each ray the distance of the sides, m; None if the eye is not inside.

        Args:
            eye: Where it is looked from, x and y, m.
            rays: Directions of length 1, a row of x and a row of y.
        """
        room = self._offsets - self._outwards @ eye
        if room.min() <= TOUCH:
            return None
        # The side that is reached first is the one towards which the ray is fastest, by the way
        # that there is. As the room is closed, there is one in each direction.
        fastest: Numbers = ((self._outwards / room[:, None]) @ rays).max(axis=0)
        return 1.0 / fastest


def see_walls(lines: Numbers, rays: Numbers) -> Numbers:
    """Return for each ray the distance of the nearest wall, m; infinity where none is.

    Args:
        lines: A row of x1, y1, x2, y2 for each wall, seen from the eye, m.
        rays: Directions of length 1, a row of x and a row of y.
    """
    x, y = lines[:, 0, None], lines[:, 1, None]
    along_x, along_y = lines[:, 2, None] - x, lines[:, 3, None] - y
    ray_x, ray_y = rays
    with np.errstate(divide='ignore', invalid='ignore', over='ignore'):
        # ray * distance = start + along * share, solved by Cramer's rule.
        cross = ray_x * along_y - ray_y * along_x
        distance = (x * along_y - y * along_x) / cross
        share = (x * ray_y - y * ray_x) / cross
    # The margin closes the corners, where two walls share a point.
    hit = (distance >= 0) & (share >= -TOUCH) & (share <= 1 + TOUCH)
    nearest: Numbers = np.where(hit, distance, math.inf).min(axis=0)
    return nearest


def see_posts(rounds: Numbers, rays: Numbers) -> Numbers:
    """Return for each ray the distance of the nearest post, m; infinity where none is.

    Args:
        rounds: A row of x, y and radius for each post, seen from the eye, m.
        rays: Directions of length 1, a row of x and a row of y.
    """
    middles, radius = rounds[:, :2], rounds[:, 2, None]
    # How far along the ray the middle of the post is, and how far beside it.
    ahead = middles @ rays
    aside = (middles[:, ::-1] * (-1.0, 1.0)) @ rays
    with np.errstate(invalid='ignore'):
        distance = ahead - np.sqrt(radius * radius - aside * aside)
    # It is not a number where the ray passes by, and then no comparison is true.
    nearest: Numbers = np.where(distance >= 0, distance, math.inf).min(axis=0)
    return nearest
