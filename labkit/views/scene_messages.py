"""Messages as shapes of a scene: pure functions, one a type of message.

Sizes and colours follow the displays of RViz where it has one: ros2/rviz, rviz_default_plugins.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from labkit.transforms.tree import Place
from labkit.views.robot_messages import beams_of
from labkit.views.scene_things import Thing, arrow, as_points, moved, numbers_of

if TYPE_CHECKING:
    from geometry_msgs.msg import PoseStamped
    from nav_msgs.msg import Odometry, Path
    from sensor_msgs.msg import LaserScan

    from labkit.sim.world import World

__all__ = [
    'odometry_things',
    'path_things',
    'pose_things',
    'scan_points',
    'scan_things',
    'world_things',
]

# Length and diameter of the arrows of a pose and of odometry, m; how large a beam's end is, px.
GOAL, ODOMETRY = (0.4, 0.03), (0.2, 0.012)
BEAM_PX = 4.0
PATH_PX, TRAIL_PX = 3.0, 2.0
# Lines are drawn this far above the floor, m, so that its grid does not cross them.
ABOVE = 0.003
# The walls of the simulator are thin lines, and as high as its scanner sees, at least, m. A wall
# is drawn this thick, m.
WALL_HEIGHT, WALL_WIDTH = 0.25, 0.02


def scan_points(message: LaserScan) -> Any:
    """Return the ends of a scan's beams in the frame of the scanner, rows of x, y and z, m."""
    ranges, angles = beams_of(message)
    hit = np.isfinite(ranges)
    ranges, angles = ranges[hit], angles[hit]
    return np.stack(
        [ranges * np.cos(angles), ranges * np.sin(angles), np.zeros(len(ranges))], axis=1
    )


def scan_things(message: LaserScan, place: Place) -> dict[str, Thing]:
    """Return what a laser scanner sees, in the fixed frame.

    Args:
        message: The scan.
        place: Where the scanner was in the fixed frame at the time of the scan.
    """
    points = as_points(moved(place, scan_points(message)))
    return {'points': Thing('points', colour='laser', points=points, width=BEAM_PX)}


def path_things(message: Path) -> dict[str, Thing]:
    """Return a path as a line; each of its poses is taken to be in the frame of the path."""
    rows = [(p.pose.position.x, p.pose.position.y, p.pose.position.z) for p in message.poses]
    if len(rows) < 2:
        return {}
    points = as_points(rows) + np.array((0, 0, ABOVE), '<f4')
    frame = message.header.frame_id
    return {'line': Thing('line', frame, colour='path', points=points, width=PATH_PX)}


def pose_things(message: PoseStamped) -> dict[str, Thing]:
    """Return a pose, such as a goal, as an arrow."""
    place = numbers_of(message.pose)
    if place is None:
        return {}
    shaft, head = arrow(message.header.frame_id, place, *GOAL, colour='goal')
    return {'shaft': shaft, 'head': head}


def odometry_things(message: Odometry, trail: Sequence[Sequence[float]]) -> dict[str, Thing]:
    """Return where odometry has a robot, as an arrow, and where it had it, as a line."""
    frame, found = message.header.frame_id, {}
    place = numbers_of(message.pose.pose)
    if place is not None:
        shaft, head = arrow(frame, place, *ODOMETRY, colour='odometry')
        found = {'shaft': shaft, 'head': head}
    if len(trail) > 1:
        points = as_points(trail) + np.array((0, 0, ABOVE), '<f4')
        found['line'] = Thing('line', frame, colour='odometry', points=points, width=TRAIL_PX)
    return found


def world_things(world: World, frame: str) -> dict[str, Thing]:
    """Return the walls and the posts of a simulated world.

    Args:
        world: The world.
        frame: The frame that has its origin.
    """
    found = {}
    for number, wall in enumerate(world.walls):
        x, y = (wall.x1 + wall.x2) / 2, (wall.y1 + wall.y2) / 2
        along = math.hypot(wall.x2 - wall.x1, wall.y2 - wall.y1)
        half = math.atan2(wall.y2 - wall.y1, wall.x2 - wall.x1) / 2
        place = ((x, y, WALL_HEIGHT / 2), (0.0, 0.0, math.sin(half), math.cos(half)))
        size = (along + WALL_WIDTH, WALL_WIDTH, WALL_HEIGHT)
        found[f'wall {number}'] = Thing('box', frame, place, size, 'wall')
    for number, post in enumerate(world.posts):
        place = ((post.x, post.y, WALL_HEIGHT / 2), (0.0, 0.0, 0.0, 1.0))
        size = (2 * post.radius, 2 * post.radius, WALL_HEIGHT)
        found[f'post {number}'] = Thing('cylinder', frame, place, size, 'post')
    return found
