"""Messages of `visualization_msgs` as shapes of a scene.

Kinds, and what their sizes mean: ros2/common_interfaces, visualization_msgs/msg/Marker.msg, and
wiki.ros.org/rviz/DisplayTypes/Marker.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from labkit.descriptions.meshes import find_mesh
from labkit.errors import LabError
from labkit.transforms.tree import Place
from labkit.views.scene_meshes import mesh_of
from labkit.views.scene_things import (
    MOST,
    Thing,
    arrow,
    composed,
    hexadecimal,
    numbers_of,
    turned_to,
)

if TYPE_CHECKING:
    from visualization_msgs.msg import Marker

__all__ = ['DELETE', 'DELETE_ALL', 'marker_things']

DELETE, DELETE_ALL = 2, 3
ARROW, CUBE, SPHERE, CYLINDER, LINE_STRIP, LINE_LIST, CUBE_LIST, SPHERE_LIST = range(8)
POINTS, TEXT, MESH, TRIANGLES, ARROW_STRIP = range(8, 13)
_SOLIDS = {CUBE: 'box', SPHERE: 'sphere', CYLINDER: 'cylinder'}
_LISTS = {CUBE_LIST: 'box', SPHERE_LIST: 'sphere'}
_OF_POINTS = {LINE_STRIP: 'line', LINE_LIST: 'lines', POINTS: 'points', TRIANGLES: 'mesh'}
# Of a longer list each one is drawn as a point.
MOST_SOLIDS = 200
# So many points of a marker are drawn.
MOST_POINTS = 100_000


def marker_things(message: Marker, frame: str, base: Place) -> tuple[list[Thing], str]:
    """Return the shapes of a marker, and why there are none, '' if there are.

    Args:
        message: The marker.
        frame: The frame that they move with; '' for the fixed one.
        base: Where the frame of the marker is in that.
    """
    pose = numbers_of(message.pose)
    rgba = [message.color.r, message.color.g, message.color.b, message.color.a]
    scale = (message.scale.x, message.scale.y, message.scale.z)
    if pose is None or not np.isfinite([*rgba, *scale]).all() or max(map(abs, scale)) > MOST:
        return [], 'its numbers are none that can be drawn'
    place = composed(base, pose)
    alpha = min(max(float(rgba[3]), 0.0), 1.0)
    colours = _colours(message)
    if alpha == 0 and colours is None:
        return [], 'its colour has alpha 0, so nothing is seen of it'
    look: dict[str, Any] = {'colour': hexadecimal(rgba), 'alpha': alpha or 1.0}
    kind = message.type
    if kind in _SOLIDS:
        if 0 in scale:
            return [], 'a number of its scale is 0'
        return [Thing(_SOLIDS[kind], frame, place, scale, **look)], ''
    if kind == TEXT:
        return [Thing('text', frame, place, text=message.text[:200], **look)], ''
    if kind == MESH:
        return _mesh(message, frame, place, scale, look)
    points = np.array([(p.x, p.y, p.z) for p in message.points[:MOST_POINTS]], np.float64)
    points = points.reshape(-1, 3)
    with np.errstate(invalid='ignore'):
        near = (np.abs(points) <= MOST).all(axis=1)
    if not near.all():
        return [], 'a place of its points is none that can be drawn'
    if kind in (ARROW, ARROW_STRIP):
        return _arrows(points, frame, place, scale, look)
    if not len(points):
        return [], 'it has no points'
    if kind in _OF_POINTS:
        return _of_points(_OF_POINTS[kind], points, colours, frame, place, scale, look)
    if kind in _LISTS:
        return _list(_LISTS[kind], points, colours, frame, place, scale, look)
    return [], f'nothing is known of its type {kind}'


def _colours(message: Marker) -> Any:
    """Return a colour for each point, None if there is none or not one for each."""
    rows = [(c.r, c.g, c.b, c.a) for c in message.colors[:MOST_POINTS]]
    if not rows or len(message.colors) != len(message.points):
        return None
    return (255 * np.clip(np.nan_to_num(np.array(rows)), 0, 1)).round().astype(np.uint8)


def _mesh(
    message: Marker, frame: str, place: Place, scale: Any, look: dict[str, Any]
) -> tuple[list[Thing], str]:
    try:
        points = mesh_of(find_mesh(message.mesh_resource))
    except LabError as error:
        return [], str(error)
    return [Thing('mesh', frame, place, scale, points=points, **look)], ''


def _arrows(
    points: Any, frame: str, place: Place, scale: Any, look: dict[str, Any]
) -> tuple[list[Thing], str]:
    """Return an arrow of a pose, or one between each two points."""
    length, width, head = scale
    if not len(points):
        if not length or not width:
            return [], 'a number of its scale is 0'
        return arrow(frame, place, length, width, **look), ''
    if len(points) < 2 or not length:
        return [], 'it needs two points, and a diameter of its shaft in scale.x'
    found = []
    for begin, end in pairwise(points):
        far = float(np.linalg.norm(end - begin))
        # Then x is the diameter of the shaft, y that of the head, z its length.
        size = (head or 0.23 * far, width or 2 * length)
        at = composed(place, (tuple(begin.tolist()), turned_to(end - begin)))
        found += arrow(frame, at, far, length, head=size, **look)
    return found, ''


def _of_points(
    shape: str, points: Any, colours: Any, frame: str, place: Place, scale: Any, look: Any
) -> tuple[list[Thing], str]:
    if shape == 'mesh':
        size, width = scale if all(scale) else (1.0, 1.0, 1.0), 1.0
        points = points[: len(points) // 3 * 3]
    else:
        size, width = (1.0, 1.0, 1.0), scale[0]
        if width <= 0:
            return [], 'scale.x, which is its width, is 0'
    if colours is not None:
        # They stand for its own colour.
        look = look | {'colour': '#ffffff', 'alpha': 1.0 if colours[:, 3].min() == 255 else 0.999}
        colours = colours[: len(points)]
    return [
        Thing(
            shape, frame, place, size, **look, points=points.astype('<f4'), colours=colours,
            width=width, metres=True,
        )
    ], ''  # fmt: skip


def _list(
    shape: str, points: Any, colours: Any, frame: str, place: Place, scale: Any, look: Any
) -> tuple[list[Thing], str]:
    if 0 in scale:
        return [], 'a number of its scale is 0'
    if len(points) > MOST_SOLIDS:
        return _of_points('points', points, colours, frame, place, scale, look)
    found = []
    for number, point in enumerate(points.tolist()):
        at = composed(place, (tuple(point), (0.0, 0.0, 0.0, 1.0)))
        if colours is not None:
            red, green, blue, alpha = (float(part) / 255 for part in colours[number])
            look = {'colour': hexadecimal((red, green, blue)), 'alpha': alpha}
        found.append(Thing(shape, frame, at, scale, **look))
    return found, ''
