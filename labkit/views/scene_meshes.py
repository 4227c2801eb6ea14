"""Meshes of files for a scene: STL, made of fewer triangles where they are many.

The format: two of them have one name, text and binary; what begins with `solid` may be either, so
the length decides. Source: loc.gov/preservation/digital/formats/fdd/fdd000506.shtml.
"""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import numpy as np

from labkit.errors import LabError, quoted
from labkit.files import read_limited

__all__ = ['MOST_TRIANGLES', 'mesh_of', 'thinned', 'triangles_of']

# A larger file is not read.
MOST_BYTES = 50_000_000
# A page without a graphics card draws some 20,000 triangles in a twentieth of a second.
MOST_TRIANGLES = 3000
# Header of a binary file, and a triangle in it: normal, corners, and a number that nobody uses.
_HEAD = 84
_TRIANGLE = np.dtype([('normal', '<f4', 3), ('corners', '<f4', (3, 3)), ('more', '<u2')])
# The finest and the coarsest grid to which corners are moved, in cells along the longest edge.
_CELLS = (96, 64, 48, 32, 24, 16, 12, 8, 6, 4)


@functools.lru_cache(maxsize=64)
def mesh_of(path: Path) -> Any:
    """Return the corners of a mesh, three rows a triangle, as many as a page can draw.

    Raises:
        LabError: The file is of another format, too large, or none.
    """
    if path.suffix.lower() != '.stl':
        raise LabError(
            f'The mesh {quoted(path.name)} is not drawn: only files of STL are.',
            todo='Convert it to .stl, or describe it by boxes, cylinders and spheres.',
        )
    try:
        data = read_limited(path, MOST_BYTES)
    except OSError as error:
        raise LabError(f'The mesh {quoted(path.name)} is not drawn: {error}.') from error
    return thinned(triangles_of(data, path.name), MOST_TRIANGLES)


def triangles_of(data: bytes, name: str) -> Any:
    """Return the triangles of an STL file: an array of three corners each.

    Args:
        data: What is in it.
        name: Its name, for the error.

    Raises:
        LabError: It is none.
    """
    count = int.from_bytes(data[80:_HEAD], 'little')
    if len(data) >= _HEAD and len(data) == _HEAD + count * _TRIANGLE.itemsize:
        found = np.frombuffer(data, _TRIANGLE, count, _HEAD)['corners'].astype(np.float64)
    else:
        words = data.split()
        rows = [words[i + 1 : i + 4] for i, word in enumerate(words) if word == b'vertex']
        try:
            found = np.array(rows, dtype=np.float64).reshape(-1, 3, 3)
        except ValueError:
            found = np.zeros((0, 3, 3))
    found = found[np.isfinite(found).all(axis=(1, 2))]
    if not len(found):
        raise LabError(f'The mesh {quoted(name)} is not drawn: it is no STL, or it is empty.')
    return found


def thinned(triangles: Any, most: int) -> Any:
    """Return corners, three rows a triangle, of no more triangles than `most`.

    What has too many is moved to a grid that is fine enough; triangles that have no area then are
    left out.
    """
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    edge = float((high - low).max()) or 1.0
    cells = iter(_CELLS)
    found = triangles
    while len(found) > most and (count := next(cells, None)) is not None:
        step = edge / count
        found = low + np.round((triangles - low) / step) * step
        a, b, c = found.swapaxes(0, 1)
        flat = (a == b).all(axis=1) | (b == c).all(axis=1) | (c == a).all(axis=1)
        found = np.unique(found[~flat].reshape(-1, 9), axis=0).reshape(-1, 3, 3)
    return found[:most].reshape(-1, 3).astype('<f4')
