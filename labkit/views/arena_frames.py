"""What the arena draws by tf2: axes of frames, scans where they were taken, and a fixed frame.

What tf2 does not know is not drawn, and is told in its words.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from labkit.sim.kinematics import Pose
from labkit.transforms.cache import NANOSECONDS
from labkit.transforms.rotations import matrix
from labkit.views.arena_picture import Axes
from labkit.views.placed_frames import PlacedFrames, nanoseconds
from labkit.views.robot_messages import beams_of

if TYPE_CHECKING:
    from rclpy.node import Node
    from sensor_msgs.msg import LaserScan

__all__ = ['ArenaFrames', 'PlacedScan']

# The ends of the beams, and the scanner.
PlacedScan = tuple[Any, tuple[float, float]]
# An axis that points out of the map, with less than this share of its length on it, is left out.
LEAST_SHARE = 0.05


class ArenaFrames(PlacedFrames):
    """Frames as tf2 hears them, for a map.

    Args:
        names: Frames whose axes are drawn.
        fixed: The frame in which all is drawn; '' for that of the odometry.
        node: See `HeardFrames`.
    """

    def __init__(self, names: Sequence[str], fixed: str, node: Node) -> None:
        super().__init__(node)
        self.names, self.fixed = tuple(names), fixed

    def base(self, what: str, frame: str) -> tuple[float, Pose] | None:
        """Return when and where the frame of an odometry is in the fixed frame; None if unknown.

        Args:
            what: See `place`.
            frame: Name of the frame.
        """
        if not self.fixed or self.fixed == frame:
            return 0.0, Pose()
        found = self.place(what, self.fixed, frame)
        if found is None:
            return None
        time, ((x, y, _), turn) = found
        across = matrix(turn)
        return time / NANOSECONDS, Pose(x, y, math.atan2(across[1][0], across[0][0]))

    def axes(self, target: str) -> list[Axes]:
        """Return the axes of the chosen frames, as far as they are known in the frame of a map."""
        found = []
        for name in self.names:
            placed = self.place(name, target, name)
            if placed is not None:
                (x, y, _), turn = placed[1]
                columns = zip(*matrix(turn), strict=True)
                tips = {
                    axis: (column[0], column[1])
                    for axis, column in zip('xyz', columns, strict=True)
                }
                on_map = {
                    axis: tip for axis, tip in tips.items() if math.hypot(*tip) >= LEAST_SHARE
                }
                found.append(Axes(name, (x, y), on_map))
        return found

    def scan(self, what: str, message: LaserScan, target: str) -> PlacedScan | None:
        """Return where the beams of a scan end in a frame, at the time of the scan.

        Args:
            what: See `place`.
            message: The scan.
            target: Name of the frame.
        """
        time = nanoseconds(message.header.stamp)
        placed = self.place(what, target, message.header.frame_id, time)
        if placed is None:
            return None
        (x, y, _), turn = placed[1]
        across = np.array(matrix(turn))[:2, :2]
        ranges, angles = beams_of(message)
        ends = np.stack([ranges * np.cos(angles), ranges * np.sin(angles)], axis=1) @ across.T
        return ends + np.array((x, y)), (x, y)
