"""The faces of boxes, cylinders, cones, spheres and meshes; the page makes the same ones."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np

from labkit.views.scene_things import Thing

__all__ = ['faces_of']

# Sides of what is round, and rings of a sphere.
SIDES, RINGS = 20, 10


def faces_of(thing: Thing, most: int) -> tuple[bool, list[Any]]:
    """Return whether a thing is closed, and its faces in its own frame, m.

    The corners of a face are in order, counter-clockwise as seen from outside. Faces with as many
    corners are one array: a row for each face, in that a row for each corner.

    Args:
        thing: A solid one.
        most: A mesh of more triangles is the box around it.
    """
    if thing.shape != 'mesh':
        return True, [faces * np.array(thing.size) for faces in _unit(thing.shape)]
    points = np.asarray(thing.points, dtype=np.float64) * thing.size
    triangles = points[: len(points) // 3 * 3].reshape(-1, 3, 3)
    triangles = triangles[np.isfinite(triangles).all(axis=(1, 2))]
    if len(triangles) <= most:
        return False, [triangles] if len(triangles) else []
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    return True, [faces * (high - low) + (high + low) / 2 for faces in _unit('box')]


@functools.cache
def _unit(shape: str) -> list[Any]:
    """Return the faces of a shape in a cube of edges of length 1."""
    if shape == 'box':
        return [_box()]
    if shape == 'sphere':
        return _sphere()
    ring = [(0.5 * math.cos(angle), 0.5 * math.sin(angle)) for angle in _angles()]
    low = np.array([(x, y, -0.5) for x, y in ring])
    if shape == 'cone':
        tip = (0.0, 0.0, 0.5)
        return [np.array([(low[i - 1], low[i], tip) for i in range(SIDES)]), low[None, ::-1]]
    high = low + np.array((0.0, 0.0, 1.0))
    sides = [(low[i - 1], low[i], high[i], high[i - 1]) for i in range(SIDES)]
    return [np.array(sides), np.array((high, low[::-1]))]


def _angles() -> list[float]:
    return [2 * math.pi * i / SIDES for i in range(SIDES)]


def _box() -> Any:
    faces = np.zeros((6, 4, 3))
    order = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    for number in range(6):
        axis, sign = number // 2, 1 - 2 * (number % 2)
        faces[number, :, axis] = sign / 2
        faces[number, :, [(axis + 1) % 3, (axis + 2) % 3]] = np.array(order[::sign]).T / 2
    return faces


def _sphere() -> list[Any]:
    def at(i: int, j: int) -> tuple[float, float, float]:
        down, angle = math.pi * i / RINGS, 2 * math.pi * j / SIDES
        level = 0.5 * math.sin(down)
        return level * math.cos(angle), level * math.sin(angle), 0.5 * math.cos(down)

    def between(i: int, j: int) -> list[tuple[float, float, float]]:
        return [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]

    # At the poles two corners are one.
    last, columns = RINGS - 1, range(SIDES)
    top = [between(0, j)[:3] for j in columns]
    bottom = [[between(last, j)[k] for k in (0, 1, 3)] for j in columns]
    rest = [between(i, j) for i in range(1, last) for j in columns]
    return [np.array(top + bottom), np.array(rest)]
