"""The camera of the simulated robot, by one ray per column.

Walls, posts and robots are upright, so one ray per column finds them, and what each pixel shows
follows from their height. NumPy does it for all columns at once: 320 by 240 pixels take a few
milliseconds.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from labkit.sim.kinematics import Pose
from labkit.sim.world import World

__all__ = ['PI_CAMERA', 'Camera', 'picture']

Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Camera:
    """A pinhole camera that looks ahead.

    Attributes:
        width: Width of the image, px.
        height: Height of the image, px.
        view: Horizontal field of view, rad.
        x: Distance ahead of the middle of the axle, m.
        z: Height above the floor, m.
        rate: Frame rate, Hz.
    """

    width: int
    height: int
    view: float
    x: float
    z: float
    rate: float

    @property
    def focal_length(self) -> float:
        """Its focal length, pixels; pixels are square."""
        return self.width / 2 / math.tan(self.view / 2)


# The Raspberry Pi camera v2 on a TurtleBot3 Burger. Sources:
# - size: ROBOTIS-GIT/turtlebot3, turtlebot3_bringup/launch/camera.launch.py: 320 by 240 pixels;
# - view: Raspberry Pi documentation, "Camera hardware", Camera Module v2: 62.2 degrees across;
# - place: ROBOTIS-GIT/turtlebot3_simulations, turtlebot3_gazebo/models/turtlebot3_burger_cam/
#   model.sdf: camera_joint 0.040 m ahead and 0.110 m above base_link, which is 0.010 m up.
# The real one makes up to 90 images a second; 10 are enough to drive by, and cheap.
PI_CAMERA = Camera(width=320, height=240, view=math.radians(62.2), x=0.04, z=0.12, rate=10.0)

# Heights, m. A Burger: 0.192 m (e-manual, "Features > Specifications").
WALL_HEIGHT, POST_HEIGHT, ROBOT_HEIGHT = 0.5, 0.4, 0.192
# Sizes of wall panels, their joints, floor tiles and rings of posts, m.
PANEL, JOINT, TILE, RING = 0.5, 0.02, 0.5, 0.1
# Walls differ in colour, so that an image tells them apart; red, green and blue, 0 to 255.
WALLS = np.array(
    [(201, 120, 96), (104, 150, 190), (126, 168, 108), (205, 172, 96), (160, 128, 184)],
    np.float32,
)
POST, POST_RING, ROBOT, ROBOT_RING = np.array(
    [(236, 236, 232), (206, 72, 56), (62, 66, 72), (239, 108, 0)], np.float32
)
LIGHT_TILE, DARK_TILE, CEILING, HORIZON = np.array(
    [(198, 196, 190), (160, 158, 154), (226, 232, 238), (190, 198, 206)], np.float32
)
# Nearer things are not seen, m.
NEAREST = 1e-3


class _Things(NamedTuple):
    """The first thing of one kind that each column meets.

    Attributes:
        depth: Distance ahead, m; infinity where there is nothing.
        light: Brightness, 0 to 1.
        colours: Its colour, and that of its rings.
        height: Its height, m.
        ring: Height of a ring, m; infinity without rings.
    """

    depth: Floats
    light: Floats
    colours: tuple[Floats, Floats]
    height: float
    ring: float


class _Rays(NamedTuple):
    """The rays of a camera: their origin, and their x and y per metre ahead."""

    x: float
    y: float
    along_x: Floats
    along_y: Floats


def picture(
    world: World, pose: Pose, *, camera: Camera = PI_CAMERA, but: str = ''
) -> NDArray[np.uint8]:
    """Return a camera image, as rows of pixels with red, green and blue.

    Args:
        world: The surroundings.
        pose: Pose of the robot that carries it.
        camera: The camera.
        but: Name of a robot to leave out: the one with the camera.
    """
    across, down = _pixels(camera)
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    rays = _Rays(
        pose.x + camera.x * cos,
        pose.y + camera.x * sin,
        (cos + across * sin).astype(np.float32),
        (sin - across * cos).astype(np.float32),
    )
    colours = _background(camera, rays)
    nearest = np.full((camera.height, camera.width), np.inf, np.float32)
    others = [post for name, post in list(world.robots.items()) if name != but]
    rings = (POST, POST_RING), (ROBOT, ROBOT_RING)
    for things in (
        _walls(rays, world),
        _posts(rays, world.posts, rings[0], POST_HEIGHT),
        _posts(rays, others, rings[1], ROBOT_HEIGHT),
    ):
        if things is None or not np.isfinite(things.depth).any():
            continue
        with np.errstate(invalid='ignore'):
            up = camera.z - down * things.depth
            covers = (up >= 0) & (up <= things.height) & (things.depth < nearest)
        rows, columns = np.nonzero(covers)
        nearest[covers] = np.broadcast_to(things.depth, covers.shape)[covers]
        plain, ring = (
            np.broadcast_to(each, (camera.width, 3))[columns] for each in things.colours
        )
        is_ring = (up[rows, columns] / things.ring).astype(np.int32) % 2 == 1
        seen = np.where(is_ring[:, None], ring, plain)
        colours[rows, columns] = seen * things.light[columns, None]
    return colours.astype(np.uint8)


@functools.cache
def _pixels(camera: Camera) -> tuple[Floats, Floats]:
    """Return how far right each column and how far down each row looks, per metre ahead."""
    across = (np.arange(camera.width) + 0.5 - camera.width / 2) / camera.focal_length
    down = (np.arange(camera.height) + 0.5 - camera.height / 2) / camera.focal_length
    return across.astype(np.float32), down.astype(np.float32)[:, None]


def _background(camera: Camera, rays: _Rays) -> Floats:
    """Return floor and ceiling up to the horizon."""
    _, down = _pixels(camera)
    half = camera.height // 2
    colours = np.empty((camera.height, camera.width, 3), np.float32)
    share = np.linspace(0, 1, half, dtype=np.float32)[:, None, None]
    colours[:half] = CEILING + share * (HORIZON - CEILING)
    ahead = camera.z / down[half:]
    tiles = np.floor((rays.x + ahead * rays.along_x) / TILE) + np.floor(
        (rays.y + ahead * rays.along_y) / TILE
    )
    # Distant tiles blur into one.
    clear = (np.exp(-ahead / 3) * (tiles % 2 - 0.5))[..., None]
    colours[half:] = (LIGHT_TILE + DARK_TILE) / 2 + clear * (LIGHT_TILE - DARK_TILE)
    return colours


def _walls(rays: _Rays, world: World) -> _Things | None:
    if not world.walls:
        return None
    lines: Any = np.array(world.walls, np.float64) - (rays.x, rays.y, rays.x, rays.y)
    x, y = lines[:, 0, None], lines[:, 1, None]
    along_x, along_y = lines[:, 2, None] - x, lines[:, 3, None] - y
    with np.errstate(divide='ignore', invalid='ignore'):
        # ray * depth = start + along * share, solved by Cramer's rule.
        cross = rays.along_x * along_y - rays.along_y * along_x
        depth = (x * along_y - y * along_x) / cross
        share = (x * rays.along_y - y * rays.along_x) / cross
    hit = (depth >= NEAREST) & (share >= -1e-6) & (share <= 1 + 1e-6)
    depth = np.where(hit, depth, np.inf)
    first = depth.argmin(axis=0)
    columns = np.arange(depth.shape[1])
    length = np.hypot(along_x, along_y)[first, 0]
    place = np.where(hit[first, columns], share[first, columns], 0.0) * length
    # Brightest when seen head-on; every other panel is a little darker, and so is each joint.
    square = np.abs(cross[first, columns]) / length / np.hypot(rays.along_x, rays.along_y)
    light = (0.7 + 0.3 * square) * np.where(place / PANEL % 2 < 1, 1.0, 0.93)
    light = np.where(place % PANEL < JOINT, 0.6, light).astype(np.float32)
    colours = WALLS[first % len(WALLS)]
    return _Things(
        depth[first, columns].astype(np.float32), light, (colours, colours), WALL_HEIGHT, math.inf
    )


def _posts(
    rays: _Rays, posts: Any, colours: tuple[Floats, Floats], height: float
) -> _Things | None:
    if not len(posts):
        return None
    rounds = np.array(posts, np.float64) - (rays.x, rays.y, 0.0)
    x, y, radius = rounds[:, 0, None], rounds[:, 1, None], rounds[:, 2, None]
    long = np.hypot(rays.along_x, rays.along_y)
    unit_x, unit_y = rays.along_x / long, rays.along_y / long
    aside = (unit_x * y - unit_y * x) / radius
    inward = np.sqrt(np.maximum(1 - aside**2, 0))
    distance = unit_x * x + unit_y * y - radius * inward
    depth = np.where((np.abs(aside) <= 1) & (distance >= NEAREST), distance / long, np.inf)
    first = depth.argmin(axis=0)
    columns = np.arange(depth.shape[1])
    # Round things are darker at their edges.
    light = (0.45 + 0.55 * inward[first, columns]).astype(np.float32)
    return _Things(depth[first, columns].astype(np.float32), light, colours, height, RING)
