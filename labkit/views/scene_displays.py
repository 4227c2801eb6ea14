"""What a scene can show, one display a topic, as RViz has them.

A display keeps the last message of its topic, and makes shapes of it when it is asked for them.
"""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, Any, ClassVar

from labkit.views.feed import Feed, checked_type
from labkit.views.live import helper
from labkit.views.placed_frames import PlacedFrames, nanoseconds
from labkit.views.robot_messages import nearest_of
from labkit.views.scene_messages import (
    burger_things,
    odometry_things,
    path_things,
    pose_things,
    scan_things,
    world_things,
)
from labkit.views.scene_things import Thing, is_same, numbers_of

if TYPE_CHECKING:
    from labkit.sim.world import World

__all__ = ['DISPLAYS', 'Display', 'RobotDisplay', 'TopicDisplay', 'WorldDisplay']

# Distance between points of a trail, m. A larger jump was not driven.
TRAIL_STEP, JUMP = 0.02, 0.5
TRAIL_LENGTH = 2000
# So many scans wait for the transforms of their time.
MAX_WAITING = 10

Things = dict[str, Thing]


class Display:
    """A part of the scene that can be switched on and off; by itself one that a page draws.

    Args:
        name: What it is called, which is also what it is known by.
        is_on: Whether it is shown.

    Attributes:
        name: See above.
        is_on: See above.
    """

    def __init__(self, name: str, *, is_on: bool = True) -> None:
        self.name, self.is_on = name, is_on

    def things(self, frames: PlacedFrames, fixed: str) -> Things:
        """Return its shapes by name. One that has not changed is the same object.

        Args:
            frames: Where frames are.
            fixed: The fixed frame.
        """
        return self._things_in(frames, fixed) if self.is_on else {}

    def words(self) -> str:
        """Return what it shows, in a sentence; '' for nothing."""
        return self._words() if self.is_on else ''

    def _things_in(self, frames: PlacedFrames, fixed: str) -> Things:
        return {}

    def _words(self) -> str:
        return ''


class RobotDisplay(Display):
    """Robots that are known by their frames: each TurtleBot3 Burger."""

    def __init__(self) -> None:
        super().__init__('robot')
        self._names: tuple[str, ...] = ()
        self._found: dict[str, Things] = {}

    def _things_in(self, frames: PlacedFrames, fixed: str) -> Things:
        names = tuple(frames.heard.tree.names())
        if names != self._names:
            self._names, self._found = names, burger_things(names)
        return {name: part for parts in self._found.values() for name, part in parts.items()}


class WorldDisplay(Display):
    """The walls and posts of a simulated world."""

    def __init__(self, world: World) -> None:
        super().__init__('walls')
        self._world = world
        self._drawn: tuple[str, Things] = ('', {})

    def _things_in(self, frames: PlacedFrames, fixed: str) -> Things:
        tree = frames.heard.tree
        frame = next((name for name in ('map', 'odom') if name in tree), fixed)
        if frame != self._drawn[0] or not self._drawn[1]:
            self._drawn = frame, world_things(self._world, frame)
        return self._drawn[1]

    def _words(self) -> str:
        walls, posts = len(self._world.walls), len(self._world.posts)
        return f'Of the simulator: {_count(walls, "wall")}, {_count(posts, "post")}.'


class TopicDisplay(Display):
    """What a topic tells.

    Args:
        topic: Its name.
        is_on: Whether it is shown.

    Attributes:
        feed: Its messages.
    """

    msg_type: ClassVar[str]
    # Whether it is on before anybody says.
    at_first: ClassVar[bool] = True
    # Whether only its newest message is of use, and there will be more.
    is_sensor: ClassVar[bool] = False

    def __init__(self, topic: str, *, is_on: bool) -> None:
        super().__init__(topic, is_on=is_on)
        self.feed = self._new_feed(topic)
        self._message: Any = None
        self._things: Things = {}
        self._drawn: object = None

    def _new_feed(self, topic: str) -> Feed:
        from rclpy.qos import QoSProfile, ReliabilityPolicy

        # Of a sensor the newest message is of use, and best effort matches every publisher. What
        # is published once has to come, also if that was before.
        best_effort = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)  # type: ignore[no-untyped-call]
        qos = best_effort if self.is_sensor else None
        kind = checked_type(self.msg_type)
        return Feed(topic, helper(), self.take, msg_type=kind, qos_profile=qos)

    @property
    def is_heard(self) -> bool:
        """Whether there is a message to show."""
        return self._message is not None

    def forget(self) -> None:
        """Forget what was heard."""
        self._message, self._things, self._drawn = None, {}, None

    def take(self, message: Any) -> None:
        """Take a message."""
        self._message = message

    def _things_in(self, frames: PlacedFrames, fixed: str) -> Things:
        message = self._message
        if message is not None and message is not self._drawn:
            self._show(self._made_of(message))
            self._drawn = message
        return self._things if self._is_placed(frames, fixed) else {}

    def _show(self, made: Things) -> None:
        """Show shapes; one that is as it was stays the same object, so that it is not sent."""
        for name, before in self._things.items():
            if name in made and is_same(made[name], before):
                made[name] = before
        self._things = made

    def _made_of(self, message: Any) -> Things:
        """Return shapes of a message, in its frame."""
        raise NotImplementedError

    def _is_placed(self, frames: PlacedFrames, fixed: str) -> bool:
        """Return whether it is known where the frame of its message is; else note the reason."""
        message = self._message
        return message is None or bool(frames.place(self.name, fixed, message.header.frame_id))


class ScanDisplay(TopicDisplay):
    """What a laser scanner sees, where it was at the time of the scan."""

    msg_type = 'sensor_msgs/msg/LaserScan'
    is_sensor = True

    def __init__(self, topic: str, *, is_on: bool) -> None:
        super().__init__(topic, is_on=is_on)
        self._waiting: deque[Any] = deque(maxlen=MAX_WAITING)
        self._fixed = ''

    def forget(self) -> None:
        super().forget()
        self._waiting.clear()

    def take(self, message: Any) -> None:
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
        time, frame = nanoseconds(message.header.stamp), message.header.frame_id
        if frames.is_late(self._fixed, frame, time) and len(self._waiting) < MAX_WAITING:
            return False
        found = frames.place(self.name, self._fixed, frame, time)
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
        return f'Laser {self.name}: {_count(count, "point")}, {near}.'


class PathDisplay(TopicDisplay):
    """A path as a line."""

    msg_type = 'nav_msgs/msg/Path'

    def _made_of(self, message: Any) -> Things:
        return path_things(message)

    def _words(self) -> str:
        poses = self._message.poses if self.is_heard else ()
        return f'Path {self.name}: {_count(len(poses), "pose")}.' if self.is_heard else ''


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


DISPLAYS: dict[str, type[TopicDisplay]] = {
    kind.msg_type: kind for kind in (ScanDisplay, PathDisplay, PoseDisplay, OdometryDisplay)
}
"""The displays by the type of their topic."""


def _place(pose: Any) -> str:
    at = pose.position
    numbers = (f'{letter} = {getattr(at, letter) + 0.0:.2f} m' for letter in 'xyz')
    return ', '.join(numbers).replace('-0.00', '0.00')


def _count(number: int, what: str) -> str:
    return f'{number} {what}' if number == 1 else f'{number} {what}s'
