"""What a scene is made of: shapes, each in a frame.

A shape is data, without ROS and without a page: what a display makes of a message is a pure
function, and so is what a page gets of it. A page draws it where its frame is; so what moves with
a frame is sent once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from labkit.transforms.rotations import Quaternion, Vector, from_rpy, matrix, product, rotated
from labkit.transforms.tree import Place

__all__ = [
    'HERE',
    'MOST',
    'Thing',
    'arrow',
    'as_points',
    'composed',
    'corners_of',
    'hexadecimal',
    'is_same',
    'moved',
    'numbers_of',
    'short',
    'told_to_page',
    'turned_to',
]

HERE: Place = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
# From the z axis, about which cylinders and cones are round, to the x axis, where arrows point.
_ALONG_X: Quaternion = from_rpy(0.0, 1.5707963267948966, 0.0)
# The head of an arrow, as RViz has it: its share of the length, and of the shaft's diameter.
HEAD_LENGTH, HEAD_WIDTH = 0.23, 2.0
# The page has numbers of single precision; what is farther away, m, is not drawn.
MOST = 1e6


@dataclass(frozen=True, eq=False)
class Thing:
    """A shape in a frame. Two are the same only if they are one object.

    Attributes:
        shape: `'box'`, `'cylinder'`, `'sphere'`, `'cone'` (its tip is up), `'mesh'`, `'line'`
            (through points), `'lines'` (pairs of ends), `'points'` or `'text'`.
        frame: The frame that it moves with; '' for the fixed frame.
        place: Where its middle is in that.
        size: Its edges, or its diameters and its height, m; of a mesh and of points, factors. Of a
            text, the last one is its height.
        colour: `'#rrggbb'`, or the name of a colour of the page's theme: see `scene.css`.
        alpha: 0 to 1.
        points: Places as an array of rows x, y and z, m: corners of a mesh, three a triangle, or
            of what has points.
        colours: A colour for each point, rows of red, green, blue and alpha, 0 to 255; None for
            one colour.
        width: Of lines and points: px, or m if `metres`.
        metres: Whether the width is in m.
        text: What a text says.
    """

    shape: str
    frame: str = ''
    place: Place = HERE
    size: Vector = (1.0, 1.0, 1.0)
    colour: str = 'thing'
    alpha: float = 1.0
    points: Any = None
    colours: Any = None
    width: float = 2.0
    metres: bool = False
    text: str = ''


def composed(outer: Place, inner: Place) -> Place:
    """Return where something is in a frame, from where that is in another one."""
    (x, y, z), turn = outer
    dx, dy, dz = rotated(turn, inner[0])
    return (x + dx, y + dy, z + dz), product(turn, inner[1])


def as_points(rows: Any) -> Any:
    """Return places as an array of rows x, y, z in single precision, without what is too far."""
    points: Any = np.asarray(rows, dtype=np.float64).reshape(-1, 3)
    with np.errstate(invalid='ignore'):
        near = (np.abs(points) <= MOST).all(axis=1)
    return points[near].astype('<f4')


def is_same(one: Thing, other: Thing) -> bool:
    """Return whether two things look the same."""

    def parts(thing: Thing) -> list[object]:
        values = (getattr(thing, each.name) for each in fields(Thing))
        return [one.tobytes() if isinstance(one, np.ndarray) else one for one in values]

    return parts(one) == parts(other)


def numbers_of(message: Any) -> Place | None:
    """Return the place in a `geometry_msgs/msg/Pose`; None if it is none.

    A turn of length 0, as in a message that nobody has filled in, is none at all.
    """
    position, turn = message.position, message.orientation
    at = (position.x, position.y, position.z)
    q = np.array((turn.x, turn.y, turn.z, turn.w))
    length = float(np.sqrt(q @ q))
    if not all(abs(number) <= MOST for number in at) or not np.isfinite(length):
        return None
    x, y, z, w = (q / length).tolist() if length > 0 else (0.0, 0.0, 0.0, 1.0)
    return at, (x, y, z, w)


def turned_to(way: Any) -> Quaternion:
    """Return the turn that lets the x axis point along a way."""
    x, y, z = (float(part) for part in way)
    return from_rpy(0.0, -math.atan2(z, math.hypot(x, y)), math.atan2(y, x))


def arrow(
    frame: str,
    place: Place,
    length: float,
    thickness: float,
    *,
    head: tuple[float, float] | None = None,
    **look: Any,
) -> list[Thing]:
    """Return an arrow that starts at a place and points along its x axis.

    Args:
        frame: The frame.
        place: Where it starts.
        length: Its length, m.
        thickness: Diameter of its shaft, m.
        head: Length and diameter of its head, m; by default as RViz has them.
        look: Colour and alpha.
    """
    tip, wide = head or (HEAD_LENGTH * length, HEAD_WIDTH * thickness)
    shaft = max(length - tip, 0.0)

    def part(shape: str, middle: float, size: Vector) -> Thing:
        at = composed(place, ((middle, 0.0, 0.0), _ALONG_X))
        return Thing(shape, frame, at, size, **look)

    return [
        part('cylinder', shaft / 2, (thickness, thickness, shaft)),
        part('cone', shaft + tip / 2, (wide, wide, tip)),
    ]


def corners_of(thing: Thing) -> Any:
    """Return places in the frame of a thing that it reaches to: an array of rows, m."""
    if thing.points is not None:
        local = np.asarray(thing.points, dtype=np.float64) * thing.size
    elif thing.shape == 'text':
        local = np.zeros((1, 3))
    else:
        signs = np.array([(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        local = signs * np.array(thing.size) / 2
    return moved(thing.place, local[np.isfinite(local).all(axis=1)])


def moved(place: Place, points: Any) -> Any:
    """Return points, rows of x, y and z, from a frame to the one in which that is at a place."""
    shift, turn = place
    return points @ np.array(matrix(turn)).T + np.array(shift)


# -- for the page -------------------------------------------------------------------------------


def short(place: Place) -> list[float]:
    """Return a place as seven numbers: where, to a hundredth of a millimetre, and the turn."""
    return [round(number, 5) for part in place for number in part]


def told_to_page(thing: Thing, buffers: list[bytes]) -> dict[str, Any]:
    """Return a thing for a page.

    Args:
        thing: The thing.
        buffers: What is sent beside the message; what is long is added to it.
    """
    told: dict[str, Any] = {'shape': thing.shape, 'at': short(thing.place), 'size': thing.size}
    told |= {'frame': thing.frame, 'colour': thing.colour, 'alpha': thing.alpha}
    if thing.points is not None:
        told |= {'points': len(buffers), 'width': thing.width, 'metres': thing.metres}
        buffers.append(thing.points.tobytes())
    if thing.colours is not None:
        told['colours'] = len(buffers)
        buffers.append(np.asarray(thing.colours, np.uint8).tobytes())
    if thing.text:
        told['text'] = thing.text
    return told


def hexadecimal(rgb: Sequence[float]) -> str:
    """Return a colour of numbers from 0 to 1 as `'#rrggbb'`."""
    red, green, blue = (round(255 * min(max(part, 0.0), 1.0)) for part in rgb[:3])
    return f'#{red:02x}{green:02x}{blue:02x}'
