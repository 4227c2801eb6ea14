"""The displays of a scene, by the types of their topics."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from labkit.descriptions.urdf import read
from labkit.errors import LabError, printable
from labkit.views.feed import checked_type
from labkit.views.image_pixels import picture_of, to_jpeg
from labkit.views.placed_frames import PlacedFrames, nanoseconds
from labkit.views.robot_messages import nearest_of
from labkit.views.scene_displays import Display, Things, TopicDisplay, counted
from labkit.views.scene_marker_display import MarkerDisplay, MarkersDisplay
from labkit.views.scene_messages import (
    odometry_things,
    path_things,
    pose_things,
    scan_things,
    world_things,
)
from labkit.views.scene_robot import robot_things
from labkit.views.scene_things import is_same, numbers_of

if TYPE_CHECKING:
    from labkit.descriptions.links_and_joints import Description
    from labkit.sim.world import World

__all__ = ['DISPLAYS', 'ImageDisplay', 'RobotDisplay', 'ScanDisplay', 'WorldDisplay']

# Distance between points of a trail, m. A larger jump was not driven.
TRAIL_STEP, JUMP = 0.02, 0.5
TRAIL_LENGTH = 2000
# Size of the picture of a camera, px, and the time between two of them, s.
INSET, PICTURE_SEC = (240, 180), 0.2
# So many scans wait for the transforms of their time.
MAX_WAITING = 10


class WorldDisplay(Display):
    """The walls and posts of a simulated world, and its crates, which may be pushed.

    Args:
        look: Returns the world as it is now.
    """

    def __init__(self, look: Callable[[], World]) -> None:
        super().__init__('walls')
        self._look = look
        self._drawn: tuple[object, ...] = ()
        self._things: Things = {}

    def _things_in(self, frames: PlacedFrames, fixed: str) -> Things:
        tree, world = frames.heard.tree, self._look()
        frame = next((name for name in ('map', 'odom') if name in tree), fixed)
        here = frame, tuple(world.walls), tuple(world.posts)
        if here != self._drawn:
            self._drawn, before = here, self._things
            self._things = {
                name: before[name] if name in before and is_same(before[name], thing) else thing
                for name, thing in world_things(world, frame).items()
            }
        return self._things

    def _words(self) -> str:
        world = self._look()
        walls, posts = len(world.walls), len(world.posts)
        return f'Of the simulator: {counted(walls, "wall")}, {counted(posts, "post")}.'


class ScanDisplay(TopicDisplay):
    """What a laser scanner sees, where it was at the time of the scan."""

    msg_type = 'sensor_msgs/msg/LaserScan'
    is_sensor = True

    def __init__(self, topic: str, *, is_on: bool) -> None:
        super().__init__(topic, is_on=is_on)
        self._waiting: deque[Any] = deque(maxlen=MAX_WAITING)
        self._fixed = ''

    def forget(self) -> None:
        """Forget scans, also those that wait."""
        super().forget()
        self._waiting.clear()

    def take(self, message: Any) -> None:
        """Take a scan, to be drawn when the transforms of its time are there."""
        self._waiting.append(message)
        super().take(message)

    def _things_in(self, frames: PlacedFrames, fixed: str) -> Things:
        if fixed != self._fixed:
            self._fixed, self._things = fixed, {}
            if self._message is not None and not self._waiting:
                self._waiting.append(self._message)
        while self._waiting and self._is_done(self._waiting[0], frames):
            self._waiting.popleft()
        return self._things

    def _is_done(self, message: Any, frames: PlacedFrames) -> bool:
        """Draw a scan, and return whether it need not wait for transforms."""
        at, frame = nanoseconds(message.header.stamp), message.header.frame_id
        if frames.is_late(self._fixed, frame, at) and len(self._waiting) < MAX_WAITING:
            return False
        found = frames.place(self.name, self._fixed, frame, at)
        self._show(scan_things(message, found[1]) if found is not None else {})
        # What is not known yet may be soon.
        return found is not None or len(self._waiting) > 1

    def _words(self) -> str:
        if self._message is None:
            return ''
        nearest = nearest_of(self._message)
        if nearest is None:
            return f'Laser {self.name}: nothing within {self._message.range_max:.1f} m.'
        near = f'the nearest {nearest[0]:.2f} m away, at {round(math.degrees(nearest[1])) + 0}°'
        points = self._things.get('points')
        count = len(points.points) if points is not None else 0
        return f'Laser {self.name}: {counted(count, "point")}, {near}.'


class PathDisplay(TopicDisplay):
    """A path as a line."""

    msg_type = 'nav_msgs/msg/Path'

    def _made_of(self, message: Any) -> Things:
        return path_things(message)

    def _words(self) -> str:
        poses = self._message.poses if self.is_heard else ()
        return f'Path {self.name}: {counted(len(poses), "pose")}.' if self.is_heard else ''


class PoseDisplay(TopicDisplay):
    """A pose, such as a goal, as an arrow."""

    msg_type = 'geometry_msgs/msg/PoseStamped'

    def _made_of(self, message: Any) -> Things:
        return pose_things(message)

    def _words(self) -> str:
        return f'Pose {self.name} at {_place(self._message.pose)}.' if self.is_heard else ''


class OdometryDisplay(TopicDisplay):
    """Where odometry has a robot, and where it had it."""

    msg_type = 'nav_msgs/msg/Odometry'
    is_sensor = True

    def __init__(self, topic: str, *, is_on: bool) -> None:
        super().__init__(topic, is_on=is_on)
        self._trail: deque[tuple[float, ...]] = deque(maxlen=TRAIL_LENGTH)
        self._frame = ''

    def forget(self) -> None:
        super().forget()
        self._trail.clear()

    def take(self, message: Any) -> None:
        place = numbers_of(message.pose.pose)
        if place is not None:
            way = math.dist(self._trail[-1], place[0]) if self._trail else math.inf
            if way > JUMP or message.header.frame_id != self._frame:
                self._trail.clear()
                self._frame = message.header.frame_id
            if way >= TRAIL_STEP:
                self._trail.append(place[0])
        super().take(message)

    def _made_of(self, message: Any) -> Things:
        return odometry_things(message, self._trail)

    def _words(self) -> str:
        at = _place(self._message.pose.pose) if self.is_heard else ''
        return at and f'Odometry {self.name} at {at}.'


class ImageDisplay(TopicDisplay):
    """What a camera sees, as an inset. It is off until somebody asks for it: it takes time."""

    msg_type = 'sensor_msgs/msg/Image'
    at_first = False
    is_sensor = True
    is_raw = True

    def __init__(self, topic: str, *, is_on: bool) -> None:
        super().__init__(topic, is_on=is_on)
        self._sent: object = None
        self._sent_at = 0.0
        self._wrong = ''

    def picture(self, *, again: bool) -> bytes | None:
        """Return the newest picture as a JPEG; None if there is no other one yet.

        Args:
            again: Whether the last one is returned, too.
        """
        data, now = self._message, time.monotonic()
        if data is None or not self.is_on:
            return None
        if not again and (data is self._sent or now - self._sent_at < PICTURE_SEC):
            return None
        self._sent, self._sent_at = data, now
        try:
            self._wrong = ''
            return to_jpeg(picture_of(self._decoded()), INSET)
        except LabError as error:
            self._wrong = str(error)
            return None

    def _things_in(self, frames: PlacedFrames, fixed: str) -> Things:
        if self._wrong:
            frames.why[self.name] = f'{self.name}: {self._wrong}'
        return {}

    def _decoded(self) -> Any:
        from rclpy.serialization import deserialize_message

        return deserialize_message(self._message, checked_type(self.msg_type))

    def _words(self) -> str:
        if not self.is_heard or self._wrong:
            return ''
        return f'Picture {self.name}: {picture_of(self._decoded()).words}.'


class RobotDisplay(TopicDisplay):
    """A robot of its description, moved by the frames of its links."""

    msg_type = 'std_msgs/msg/String'

    def __init__(self, topic: str, *, is_on: bool) -> None:
        super().__init__(topic, is_on=is_on)
        self._description: Description | None = None
        self._wrong: list[str] = []

    @property
    def is_awaited(self) -> bool:
        """Whether a picture waits for it: a robot that is there says soon what it looks like."""
        return True

    @property
    def root(self) -> str:
        """The frame of its root, '' if it is not described."""
        return self._description.root if self._description is not None else ''

    def forget(self) -> None:
        """Forget it, until it is described again."""
        super().forget()
        self._description, self._wrong = None, []

    def _made_of(self, message: Any) -> Things:
        try:
            self._description = read(message.data)
        except LabError as error:
            self._description, self._wrong = None, [str(error)]
            return {}
        things, self._wrong = robot_things(self._description)
        return things

    def _is_placed(self, frames: PlacedFrames, fixed: str) -> bool:
        tree = frames.heard.tree
        lost = next((each.frame for each in self._things.values() if each.frame not in tree), '')
        if self._description is not None:
            frames.place(self.name, fixed, lost or self._description.root)
        if self._wrong:
            frames.why[self.name] = f'{self.name}: {self._wrong[0]}'
        return True

    def _words(self) -> str:
        found = self._description
        if found is None:
            return ''
        return f'Robot {printable(found.name)}, {self.name}: {counted(len(found.links), "link")}.'


DISPLAYS: dict[str, type[TopicDisplay]] = {
    kind.msg_type: kind
    for kind in (
        *(ScanDisplay, PathDisplay, PoseDisplay, OdometryDisplay),
        *(MarkerDisplay, MarkersDisplay, ImageDisplay),
    )
}
"""The displays by the type of their topic."""


def _place(pose: Any) -> str:
    at = pose.position
    numbers = (f'{letter} = {getattr(at, letter) + 0.0:.2f} m' for letter in 'xyz')
    return ', '.join(numbers).replace('-0.00', '0.00')
