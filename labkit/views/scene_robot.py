"""A robot of its description as shapes of a scene, each in the frame of its link."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from labkit.descriptions.links_and_joints import (
    GREY,
    Box,
    Collision,
    Cylinder,
    Description,
    Geometry,
    Mesh,
    Sphere,
    Visual,
)
from labkit.descriptions.meshes import find_mesh
from labkit.errors import LabError
from labkit.views.scene_meshes import mesh_of
from labkit.views.scene_things import Thing, hexadecimal

__all__ = ['robot_things']


def robot_things(
    description: Description, *, load: Callable[[Path], Any] = mesh_of
) -> tuple[dict[str, Thing], list[str]]:
    """Return the shapes of a robot, and why some are not as they are described.

    Where a mesh can't be had, what others touch of its link is drawn in its stead.

    Args:
        description: The robot.
        load: Returns the corners of a mesh, three rows a triangle.
    """
    found: dict[str, Thing] = {}
    wrong: list[str] = []
    for link in description.links.values():
        try:
            things = [_thing(link.name, visual, load) for visual in link.visuals]
        except LabError as error:
            wrong.append(str(error))
            shapes: list[Visual | Collision] = [*link.visuals, *link.collisions]
            things = [
                _thing(link.name, shape, load)
                for shape in shapes
                if not isinstance(shape.geometry, Mesh)
            ]
        for number, thing in enumerate(things):
            found[f'{link.name} {number}' if number else link.name] = thing
    return found, wrong


def _thing(frame: str, shape: Visual | Collision, load: Callable[[Path], Any]) -> Thing:
    kind, size, points = _geometry(shape.geometry, load)
    rgba = shape.material.rgba if isinstance(shape, Visual) else GREY
    return Thing(
        kind,
        frame,
        (shape.origin.xyz, shape.origin.turn),
        size,
        hexadecimal(rgba),
        min(max(rgba[3], 0.0), 1.0),
        points,
    )


def _geometry(
    geometry: Geometry, load: Callable[[Path], Any]
) -> tuple[str, tuple[float, float, float], Any]:
    """Return shape, size and points; see `Thing`."""
    if isinstance(geometry, Box):
        return 'box', geometry.size, None
    if isinstance(geometry, Cylinder):
        wide = 2 * geometry.radius
        return 'cylinder', (wide, wide, geometry.length), None
    if isinstance(geometry, Sphere):
        return 'sphere', (2 * geometry.radius,) * 3, None
    return 'mesh', geometry.scale, load(find_mesh(geometry.filename))
