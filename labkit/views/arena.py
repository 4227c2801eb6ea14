"""The robot's arena: a live map of what is heard on `/odom` and `/scan`. `lab.arena()`.

It is an ordinary subscriber of those topics and knows nothing else, so it shows a robot in Gazebo
or a real one as well. Python keeps the scene and tells it in words; a canvas in the page draws
it. Where widgets can't run, the scene is shown as a picture (`labkit.views.arena_picture`).
"""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from labkit.background.patience import busyness
from labkit.errors import LabError
from labkit.sim.kinematics import BURGER, Pose, Twist2, wrap_angle
from labkit.views.arena_picture import Scene, to_svg
from labkit.views.feed import Feed, heard
from labkit.views.live import helper
from labkit.views.live_page import LivePage, News
from labkit.views.robot_messages import beam_ends, motion_of, nearest_of, scanner_place

if TYPE_CHECKING:
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import LaserScan

__all__ = ['Arena', 'arena']

# Words change no more often than this, s: a screen reader has to be able to speak them.
WORDS_SEC = 1.0
# A point of the trail, m from the one before. A longer way at once is none that was driven.
TRAIL_STEP, JUMP = 0.01, 0.5
TRAIL_LENGTH = 5000
# The page lets a robot glide as it was for no longer than this, s, when it hears nothing of it.
GLIDE_SEC = 0.12
# The robot touches what is so near to it, m: the scanner's noise, and what it moves in a round.
TOUCH = 0.015
# It was stopped by that if it is ahead by this angle or less, rad.
AHEAD = math.radians(80)
# Walls are remembered at one point of each square of this size, m.
SQUARE = 0.02
MOST_MET = 20_000
# How long a picture waits for the first message of a topic that somebody publishes, s, on a calm
# machine.
FIRST_SEC = 1.0


class Arena(LivePage):
    """A live map around one robot, to be shown in a cell; see `arena`.

    Attributes:
        odom: Full name of the topic with the odometry.
        scan: Full name of the topic with the laser scan.
        scene: What was heard last.
    """

    _name = 'arena'
    # For what nobody tells; else news goes to the page with the odometry that brings it.
    _period = 0.25

    def __init__(
        self, *, odom: str, scan: str, namespace: str, goals: Iterable[tuple[float, float]]
    ) -> None:
        self.scene = Scene(goals=_checked(goals))
        super().__init__(_feeds(odom, scan, namespace, self))
        self.odom, self.scan = (feed.topic for feed in self._feeds)
        self._trail: deque[tuple[float, float]] = deque(maxlen=TRAIL_LENGTH)
        # The topics on which something has come since it listens.
        self._heard: set[str] = set()
        # Where walls were seen, by square.
        self._met: dict[int, list[float]] = {}
        # The last scan: as it was heard, where its beams ended, and while the scene has it not.
        self._heard_scan: tuple[object, Pose] | None = None
        self._ends: Any = None
        self._unseen: LaserScan | None = None
        # A scan that came before it was known where the robot is: a robot that stands still may
        # not send another one.
        self._early: LaserScan | None = None
        # What the page does not know yet.
        self._fresh = True
        self._lifted = False
        self._new_trail: list[float] = []
        self._new_scan = self._last_scan = b''
        self._eye: tuple[float, float] | None = None
        self._told_twist: Twist2 | None = None
        self._worded_at = 0.0

    # -- for cells ------------------------------------------------------------------------------

    @property
    def text(self) -> str:
        """What there is to see, in words."""
        self._look_at_scan()
        return self.scene.words() or (
            f'Nothing was heard on {self.odom} yet. Start a robot with lab.spin(lab.Turtlebot()).'
        )

    def __repr__(self) -> str:
        self._wait_for_first()
        return self.text

    def _still(self) -> dict[str, str]:
        if self._watched and not self._ended and self._node is None:
            # Before the page asks for it: it can't while the cell goes on and lets a robot drive.
            self._open()
        self._wait_for_first()
        return self._stored_form()

    def _stored_form(self) -> dict[str, str]:
        with self._lock:
            self._look_at_scan()
            self.scene.trail = list(self._trail)
            return {'text/plain': self.text, 'image/svg+xml': to_svg(self.scene, self.text)}

    # -- ROS ------------------------------------------------------------------------------------

    def _wait_for_first(self) -> None:
        """Give topics that are published a moment to be heard, so that there is a picture."""
        if self._ended:
            return
        if self._node is None:
            self._heard.clear()

        def enough() -> bool:
            return all(feed.topic in self._heard or not feed.publishers for feed in self._feeds)

        with heard(self._feeds, enough, timeout_sec=FIRST_SEC * busyness()):
            pass

    def _on_odometry(self, message: Odometry) -> None:
        motion = motion_of(message)
        if motion is None:
            return
        pose, twist = motion
        point = (pose.x, pose.y)
        self._heard.add(self.odom)
        with self._lock:
            scene = self.scene
            way = math.dist(self._trail[-1], point) if self._trail else math.inf
            if way > JUMP:
                # The robot was put there: its path begins anew.
                self._trail.clear()
                self._new_trail.clear()
                self._lifted = True
            if way > JUMP or twist.v:
                scene.bump = None
            elif scene.twist.v:
                scene.bump = self._touched(pose, scene.twist.v)
                # A bump is told at once.
                self._worded_at = 0.0 if scene.bump else self._worded_at
            scene.pose, scene.twist = motion
            early, self._early = self._early, None
            if early is not None:
                self._on_scan(early)
            if way >= TRAIL_STEP:
                self._trail.append(point)
                self._new_trail += point
            # The page lets the robot go on as it did: it has to know when that is not so.
            late = twist != Twist2() and time.monotonic() - self._sent_at >= GLIDE_SEC
            if self._node is not None and (late or twist != self._told_twist):
                self._send()

    def _on_scan(self, message: LaserScan) -> None:
        with self._lock:
            pose = self.scene.pose
            if pose is None:
                self._early = message
                return
            self._heard.add(self.scan)
            if self._heard_scan == (message.ranges, pose):
                return  # while it stands, each is like the one before
            self._heard_scan = (message.ranges, pose)
            self._unseen = message
            ends = self._ends = beam_ends(message, pose)
            self._eye = scanner_place(pose)
            self._new_scan = ends.astype('<f4').tobytes()
            walls = ends[np.isfinite(ends[:, 0])]
            squares = np.rint(walls / SQUARE).astype(np.int64) @ (1 << 32, 1)
            self._met.update(zip(squares.tolist(), walls.tolist(), strict=True))
            while len(self._met) > MOST_MET:
                del self._met[next(iter(self._met))]

    def _look_at_scan(self) -> None:
        """Put the last scan into the scene: not each is looked at."""
        with self._lock:
            message, self._unseen = self._unseen, None
            if message is None:
                return
            self.scene.scan = [
                (end[0], end[1]) if end[0] == end[0] else None for end in self._ends.tolist()
            ]
            self.scene.reach = float(message.range_max)
            self.scene.nearest = nearest_of(message)

    def _touched(self, pose: Pose, v: float) -> tuple[float, float] | None:
        """Return the nearest of what is close ahead of a robot that drove and stands now."""
        ahead = pose.yaw if v > 0 else pose.yaw + math.pi

        def turn(point: list[float]) -> float:
            return wrap_angle(math.atan2(point[1] - pose.y, point[0] - pose.x) - ahead)

        near = BURGER.radius + TOUCH
        close = [point for point in self._met.values() if math.dist(point, pose[:2]) <= near]
        touched = [point for point in close if abs(turn(point)) <= AHEAD]
        if not touched:
            return None
        x, y = min(touched, key=lambda point: math.dist(point, pose[:2]))
        return x, y

    # -- the page -------------------------------------------------------------------------------

    def _news(self, everything: bool) -> News:
        scene, now = self.scene, time.monotonic()
        buffers: list[bytes] = []
        if everything:
            self._lifted, self._new_scan = True, self._new_scan or self._last_scan
            self._new_trail = [number for point in self._trail for number in point]
        state: dict[str, object] = {'goals': scene.goals, 'bump': scene.bump}
        if scene.pose is not None:
            state['pose'] = (*scene.pose, *scene.twist)
            self._told_twist = scene.twist
        if everything or now - self._worded_at >= WORDS_SEC:
            self._worded_at = now
            silences = (feed.silence() for feed in self._feeds)
            state |= {'text': self.text, 'note': next(filter(None, silences), '')}
        news = self._new_of(state)
        if self._lifted or self._new_trail:
            news |= {'lifted': self._lifted, 'trail': self._new_trail}
        if self._new_scan:
            news['eye'] = self._eye
            buffers.append(self._new_scan)
        if everything:
            # Its cell was run just now: only then the page scrolls there.
            news |= {'fresh': self._fresh, 'met': True}
            buffers.append(np.array([*self._met.values()], '<f4').tobytes())
            self._fresh = False
        self._last_scan = self._new_scan or self._last_scan
        self._lifted, self._new_trail, self._new_scan = False, [], b''
        return news, buffers


def arena(
    *,
    odom: str = 'odom',
    scan: str = 'scan',
    namespace: str = '',
    goals: Iterable[tuple[float, float]] = (),
) -> Arena:
    """Show a live map of what a robot says on `/odom` and `/scan`.

    The robot, where it looks, the path that it has driven, and the walls as its scanner sees
    them. What was seen stays; what it bumps into is marked. Mouse, keys and buttons zoom and move
    the map. Where the same cell shows `lab.teleop()`, map and keys stand side by side.

    Args:
        odom: Topic with the robot's `nav_msgs/msg/Odometry`.
        scan: Topic with its `sensor_msgs/msg/LaserScan`.
        namespace: For one of several robots: `'robot1'` makes these `/robot1/odom` and so on.
        goals: Points (x, y) to be marked, m, in the frame of the odometry.

    Returns:
        What a cell shows as a map, and `print()` as text. `.close()` ends it.

    Raises:
        LabError: A goal is not a pair of numbers.
    """
    return Arena(odom=odom, scan=scan, namespace=namespace, goals=goals)


def _feeds(odom: str, scan: str, namespace: str, view: Arena) -> list[Feed]:
    """Return what an arena listens to."""
    from nav_msgs.msg import Odometry
    from rclpy.qos import QoSProfile, ReliabilityPolicy
    from sensor_msgs.msg import LaserScan

    # Best effort hears every publisher, whatever it offers.
    qos = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)  # type: ignore[no-untyped-call]
    return [
        Feed(_full_name(topic, namespace), helper(), take, msg_type=msg_type, qos_profile=qos)
        for topic, msg_type, take in (
            (odom, Odometry, view._on_odometry),
            (scan, LaserScan, view._on_scan),
        )
    ]


def _full_name(topic: str, namespace: str) -> str:
    space = namespace.strip('/')
    return topic if topic.startswith('/') else f'/{space}/{topic}' if space else f'/{topic}'


def _checked(goals: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
    try:
        points = [(float(x), float(y)) for x, y in goals]
        if all(math.isfinite(number) for point in points for number in point):
            return points
    except (TypeError, ValueError):
        pass
    raise LabError(
        f'goals must be pairs of numbers, in metres, but they are {goals!r}.',
        todo='Write them like this: lab.arena(goals=[(1.0, 0.5)])',
    )
