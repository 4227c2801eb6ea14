"""One robot on the map of `lab.arena()`: what is heard of it, and what the page has of that."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from labkit.sim.kinematics import Pose, Twist2, wrap_angle
from labkit.sim.robots import BURGER
from labkit.views.arena_picture import Scene
from labkit.views.live_page import Update
from labkit.views.placed_frames import nanoseconds
from labkit.views.robot_messages import beam_ends, motion_of, nearest_of, scanner_place

if TYPE_CHECKING:
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import LaserScan

    from labkit.views.arena_frames import ArenaFrames, PlacedScan
    from labkit.views.feed import Feed
    from labkit.views.timed_out import TimedOut

__all__ = ['MappedRobot']

# Distance between points of the trail, m. A larger jump was not driven.
TRAIL_STEP, JUMP = 0.01, 0.5
TRAIL_LENGTH = 5000
# The page extrapolates the motion of the robot for no longer than this without changes, s.
GLIDE_SEC = 0.12
# The robot touches an obstacle this close to it, m: scanner noise plus its motion between scans.
TOUCH = 0.015
# An obstacle within this angle of straight ahead can have stopped it, rad.
AHEAD = math.radians(80)
# Walls are remembered as one point per square of this size, m.
SQUARE = 0.02
MAX_WALLS = 20_000
# A scan is drawn where the robot was at its time. It waits for the odometry of that time, unless
# that is so near, s, or so far that it must be of another clock; and not for ever.
NEAR_SEC, FAR_SEC = 0.01, 10.0
MAX_WAITING = 30
MAX_POSES = 300
# Stamps that are no farther apart than this, s, are the same.
SAME_SEC = 1e-4


class MappedRobot:
    """A robot as the arena hears it. The arena's lock guards it.

    Args:
        name: Its namespace, '' for the root.
        goals: Points to mark.

    Attributes:
        scene: The robot and its surroundings.
        trail: Where it was, oldest first.
        feeds: Its odometry, its scan, and whether its command timeout has stopped it.
        timed_out: The last of them.
        others: The other robots on the map.
        frame: The frame of its odometry, '' before the first message.
        frames: Where tf2 says that scans were taken; None to trust the odometry, and that the
            scanner is where a Burger has it.
        has_gone: Whether it was there, and nobody publishes its odometry any more.
    """

    def __init__(self, name: str, goals: Sequence[tuple[float, ...]]) -> None:
        self.name = name
        self.frame, self.has_gone = '', False
        self.scene = Scene(name=name, goals=[(x, y) for x, y, *_ in goals])
        self.trail: deque[tuple[float, float]] = deque(maxlen=TRAIL_LENGTH)
        self.feeds: list[Feed] = []
        self.timed_out: TimedOut | None = None
        self.frames: ArenaFrames | None = None
        self.others: list[MappedRobot] = []
        # Topics with a message since the subscription began.
        self._heard: set[str] = set()
        # Wall points by square.
        self._walls: dict[int, list[float]] = {}
        # The last scan: as received, the ends of its beams, and the message until the scene has
        # it.
        self._received_scan: tuple[object, Pose] | None = None
        self._ends: Any = None
        self._unread_scan: LaserScan | None = None
        # Where it was, by the time of the odometry, s; and the scans that no odometry is known of.
        self._poses: deque[tuple[float, Pose, Twist2]] = deque(maxlen=MAX_POSES)
        self._waiting: deque[LaserScan] = deque(maxlen=MAX_WAITING)
        # Changes that the page has not received yet, and what it has.
        self._lifted = False
        self._new_trail: list[float] = []
        self._new_scan = self._last_scan = b''
        self._scanner: tuple[float, float] | None = None
        self._in_page: dict[str, object] = {}
        self._sent_twist: Twist2 | None = None

    # -- ROS ------------------------------------------------------------------------------------

    @property
    def is_heard(self) -> bool:
        """Whether each of its topics has told something, or has no publisher."""
        told = self.timed_out is None or self.timed_out.is_heard
        return told and all(
            feed.topic in self._heard or not feed.publishers for feed in self.feeds[:2]
        )

    def forget_heard(self) -> None:
        """Wait anew for a message of each topic."""
        self._heard.clear()

    def take_odometry(self, message: Odometry) -> bool:
        """Move the robot, and return whether it has just bumped into something."""
        motion = motion_of(message)
        if motion is None:
            return False
        pose, twist = motion
        point = (pose.x, pose.y)
        self._heard.add(self.feeds[0].topic)
        self.frame, self.has_gone = message.header.frame_id, False
        scene, bumped = self.scene, False
        way = math.dist(self.trail[-1], point) if self.trail else math.inf
        if way > JUMP:
            # The robot was moved by hand: its path starts over.
            self.trail.clear()
            self._new_trail.clear()
            self._lifted = True
        if way > JUMP or twist.v:
            scene.bump = None
        elif scene.twist.v:
            scene.bump = self._touched(pose, scene.twist.v)
            bumped = scene.bump is not None
        scene.pose, scene.twist = motion
        at = _seconds(message)
        if self._poses and at < self._poses[-1][0]:
            self._poses.clear()  # its clock began anew
            self._waiting.clear()
        self._poses.append((at, *motion))
        self._place_scans()
        if way >= TRAIL_STEP:
            self.trail.append(point)
            self._new_trail += point
        return bumped

    def is_news(self, sent_at: float) -> bool:
        """Return whether the page is wrong about its motion.

        Args:
            sent_at: `time.monotonic()` of the last update of the page.
        """
        # The page extrapolates the motion, so it has to know when that is no longer true.
        twist = self.scene.twist
        late = twist != Twist2() and time.monotonic() - sent_at >= GLIDE_SEC
        return late or twist != self._sent_twist

    def take_scan(self, message: LaserScan) -> None:
        """Take what its scanner sees."""
        self._waiting.append(message)
        self._place_scans()

    def forget(self) -> None:
        """Take it from the map. Walls stay."""
        self.has_gone = True
        self.scene = Scene(name=self.name, goals=self.scene.goals)
        self.trail.clear()
        self._poses.clear()
        self._waiting.clear()
        self._received_scan = self._unread_scan = self._scanner = self._sent_twist = None
        self._new_scan = self._last_scan = b''
        self._new_trail.clear()

    def _place_scans(self) -> None:
        while self._waiting and (pose := self._pose_of(self._waiting[0])) is not None:
            message, frames = self._waiting[0], self.frames
            if frames is None:
                self._place(message, pose, (beam_ends(message, pose), scanner_place(pose)))
            elif self._is_late(message) and len(self._waiting) < MAX_WAITING:
                return
            elif (placed := frames.scan(self.scan_name, message, self.frame)) is not None:
                self._place(message, pose, placed)
            else:
                self._heard.add(self.feeds[1].topic)
                if len(self._waiting) == 1:
                    return  # what is not known yet may be soon
            self._waiting.popleft()

    def _is_late(self, message: LaserScan) -> bool:
        """Return whether the transforms of a scan's time are still to come."""
        assert self.frames is not None
        header = message.header
        return self.frames.is_late(self.frame, header.frame_id, nanoseconds(header.stamp))

    @property
    def scan_name(self) -> str:
        """What its scan is called where it can't be drawn."""
        return f'The scan on {self.feeds[1].topic}'

    def pose_at(self, at: float) -> Pose | None:
        """Return where it was at a time, s, if that is among what is remembered."""
        known = [pose for time, pose, _ in self._poses if abs(time - at) < SAME_SEC]
        return known[-1] if known else self.scene.pose

    def _pose_of(self, message: LaserScan) -> Pose | None:
        """Return where the robot was at the time of a scan; None if that is still to come."""
        if not self._poses:
            return None
        at, latest = _seconds(message), self._poses[-1]
        ahead = at - latest[0]
        if NEAR_SEC < ahead < FAR_SEC and len(self._waiting) < MAX_WAITING:
            return None
        if not self._poses[0][0] <= at < latest[0] + FAR_SEC:
            return latest[1]
        since, pose, twist = next(each for each in reversed(self._poses) if each[0] <= at)
        way, turn = twist.v * (at - since), twist.w * (at - since)
        middle = pose.yaw + turn / 2
        x, y = pose.x + way * math.cos(middle), pose.y + way * math.sin(middle)
        return Pose(x, y, pose.yaw + turn)

    def _place(self, message: LaserScan, pose: Pose, placed: PlacedScan) -> None:
        self._heard.add(self.feeds[1].topic)
        if self._received_scan == (message.ranges, pose):
            return  # at rest, every scan is the same
        self._received_scan = (message.ranges, pose)
        self._unread_scan = message
        ends, self._scanner = placed
        self._ends = ends
        self._new_scan = ends.astype('<f4').tobytes()
        walls = ends[np.isfinite(ends[:, 0])]
        for other in self._places_of_others():
            # Robots drive on, walls stay.
            walls = walls[np.hypot(*(walls - other).T) > BURGER.radius + TOUCH]
        squares = np.rint(walls / SQUARE).astype(np.int64) @ (1 << 32, 1)
        self._walls.update(zip(squares.tolist(), walls.tolist(), strict=True))
        while len(self._walls) > MAX_WALLS:
            del self._walls[next(iter(self._walls))]

    def current_scene(self) -> Scene:
        """Return the scene with the latest scan: not every scan is needed."""
        self._place_scans()
        message, self._unread_scan = self._unread_scan, None
        if message is not None:
            self.scene.scan = [
                (end[0], end[1]) if end[0] == end[0] else None for end in self._ends.tolist()
            ]
            self.scene.reach = float(message.range_max)
            self.scene.nearest = nearest_of(message)
            self.scene.eye = self._scanner if self.frames is not None else None
        self.scene.trail = list(self.trail)
        self.scene.why = self.timed_out.words if self.timed_out is not None else ''
        return self.scene

    def _places_of_others(self) -> list[tuple[float, float]]:
        poses = [other.scene.pose for other in self.others]
        return [(pose.x, pose.y) for pose in poses if pose is not None]

    def _touched(self, pose: Pose, v: float) -> tuple[float, float] | None:
        """Return the nearest point of a thing close ahead of a robot that has just stopped."""
        ahead = pose.yaw if v > 0 else pose.yaw + math.pi

        def turn(point: Sequence[float]) -> float:
            return wrap_angle(math.atan2(point[1] - pose.y, point[0] - pose.x) - ahead)

        near = BURGER.radius + TOUCH
        points: list[Sequence[float]] = [*self._walls.values()]
        for x, y in self._places_of_others():
            share = BURGER.radius / (math.dist((x, y), pose[:2]) or 1.0)
            points.append((x + share * (pose.x - x), y + share * (pose.y - y)))
        close = [point for point in points if math.dist(point, pose[:2]) <= near]
        touched = [point for point in close if abs(turn(point)) <= AHEAD]
        if not touched:
            return None
        x, y = min(touched, key=lambda point: math.dist(point, pose[:2]))
        return x, y

    # -- the page -------------------------------------------------------------------------------

    def update(self, everything: bool, pose: Pose | None = None) -> Update:
        """Return what the page does not know of it yet, or everything.

        Args:
            everything: Whether the page knows nothing.
            pose: Where it is drawn, if it is not its latest pose.
        """
        self._place_scans()
        scene = self.scene
        buffers: list[bytes] = []
        if scene.pose is None:
            was_there = bool(self._in_page)
            self._in_page.clear()
            return ({'gone': True} if was_there else {}), buffers
        if everything:
            self._in_page.clear()
            self._lifted, self._new_scan = True, self._new_scan or self._last_scan
            self._new_trail = [number for point in self.trail for number in point]
        state: dict[str, object] = {
            'pose': (*(pose or scene.pose), *scene.twist),
            'bump': scene.bump,
        }
        changes = {
            key: value
            for key, value in state.items()
            if key not in self._in_page or self._in_page[key] != value
        }
        self._in_page.update(state)
        self._sent_twist = scene.twist
        if self._lifted or self._new_trail:
            changes |= {'lifted': self._lifted, 'trail': self._new_trail}
        if self._new_scan:
            changes['eye'] = self._scanner
            buffers.append(self._new_scan)
        if everything:
            changes['met'] = True
            buffers.append(np.array([*self._walls.values()], '<f4').tobytes())
        self._last_scan = self._new_scan or self._last_scan
        self._lifted, self._new_trail, self._new_scan = False, [], b''
        return changes, buffers


def _seconds(message: Odometry | LaserScan) -> float:
    """Return the time in the header of a message, s."""
    stamp = message.header.stamp
    return float(stamp.sec + stamp.nanosec * 1e-9)
