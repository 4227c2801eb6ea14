"""Distances to walls and posts along many rays at once, with NumPy: pure geometry in metres.

The laser scanner has 360 rays; a Python loop over them would take milliseconds.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ['TOUCH', 'Convex', 'see_posts', 'see_walls']

# Tolerance for equal positions, m: far below what can be seen, far above rounding errors.
TOUCH = 1e-9
Numbers = NDArray[np.float64]


class Convex:
    """The sides of a convex room, as infinite lines seen from inside.

    A ray from inside leaves the room through the first line it reaches, so the ends of the sides
    do not matter.

    Args:
        corners: The corners, one after the other, at least three, m.
    """

    def __init__(self, corners: Sequence[tuple[float, float]]) -> None:
        points = np.array(corners, dtype=float)
        along = np.roll(points, -1, axis=0) - points
        outwards = np.column_stack((along[:, 1], -along[:, 0]))
        outwards /= np.hypot(*along.T)[:, None]
        offsets = np.sum(outwards * points, axis=1)
        # Corners may go round either way; their mean is inside.
        sign = 1.0 if np.all(offsets >= outwards @ points.mean(axis=0)) else -1.0
        self._outwards: Numbers = sign * outwards
        self._offsets: Numbers = sign * offsets

    def see(self, eye: Numbers, rays: Numbers) -> Numbers | None:
        """Return the distance to the sides along each ray, m; None if the eye is not inside.

        Args:
            eye: Position of the observer, x and y, m.
            rays: Directions of length 1, a row of x and a row of y.
        """
        room = self._offsets - self._outwards @ eye
        if room.min() <= TOUCH:
            return None
        # The side reached first is the one that the ray approaches fastest, relative to its
        # distance. The room is closed, so there is one in each direction.
        fastest: Numbers = ((self._outwards / room[:, None]) @ rays).max(axis=0)
        return 1.0 / fastest


def see_walls(lines: Numbers, rays: Numbers) -> Numbers:
    """Return the distance to the nearest wall along each ray, m; infinity if there is none.

    Args:
        lines: A row of x1, y1, x2, y2 for each wall, relative to the eye, m.
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
    # The tolerance closes corners, where two walls share a point.
    hit = (distance >= 0) & (share >= -TOUCH) & (share <= 1 + TOUCH)
    nearest: Numbers = np.where(hit, distance, math.inf).min(axis=0)
    return nearest


def see_posts(rounds: Numbers, rays: Numbers) -> Numbers:
    """Return the distance to the nearest post along each ray, m; infinity if there is none.

    Args:
        rounds: A row of x, y and radius for each post, relative to the eye, m.
        rays: Directions of length 1, a row of x and a row of y.
    """
    middles, radius = rounds[:, :2], rounds[:, 2, None]
    # Distance of the post's centre along the ray, and beside it.
    ahead = middles @ rays
    aside = (middles[:, ::-1] * (-1.0, 1.0)) @ rays
    with np.errstate(invalid='ignore'):
        distance = ahead - np.sqrt(radius * radius - aside * aside)
    # It is NaN where the ray misses, and then no comparison is true.
    nearest: Numbers = np.where(distance >= 0, distance, math.inf).min(axis=0)
    return nearest
