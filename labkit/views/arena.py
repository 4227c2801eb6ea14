"""The robot's arena: a live map of what is heard on `/odom` and `/scan`. `lab.arena()`.

It is an ordinary subscriber of those topics and knows nothing else, so it shows a robot in Gazebo
or a real one as well. Python keeps the scene and tells it in words; a canvas in the page draws
it. Where widgets can't run, the scene is shown as a picture (`labkit.views.arena_picture`).
"""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import anywidget
import numpy as np

from labkit import settings
from labkit.background.runtime import runtime
from labkit.errors import LabError
from labkit.sim.kinematics import BURGER, Pose, Twist2, wrap_angle, yaw_from_quaternion
from labkit.views.arena_picture import Scene, to_svg
from labkit.views.live import replace_earlier

__all__ = ['Arena', 'arena']

# The page gets news at most this often, Hz.
FRAME_RATE = 30.0
# Words change no more often than this, s: a screen reader has to be able to speak them.
WORDS_SEC = 1.0
# A point of the trail, m from the one before. A longer way at once is none that was driven.
TRAIL_STEP, JUMP = 0.01, 0.5
TRAIL_LENGTH = 5000
# How long a picture waits for the first message of a topic that somebody publishes, s.
FIRST_SEC = 1.0
# A page that sees the robot stand is told so this often, s.
STANDING_SEC = 1.0

# The arenas that live, each with the cell and its execution that made it.
_live: dict[Arena, tuple[str, str]] = {}


class _Canvas(anywidget.AnyWidget):
    """The canvas in the page. It draws what it is sent, and says when it is seen and gone."""

    _esm = Path(__file__).with_name('arena.js')
    _css = Path(__file__).with_name('arena.css')


class Arena:
    """A live map around one robot, to be shown in a cell; see `arena`.

    Attributes:
        odom: Full name of the topic with the odometry.
        scan: Full name of the topic with the laser scan.
        scene: What was heard last.
    """

    def __init__(
        self, *, odom: str, scan: str, namespace: str, goals: Iterable[tuple[float, float]]
    ) -> None:
        runtime.start()
        self.odom, self.scan = _full_name(odom, namespace), _full_name(scan, namespace)
        self.scene = Scene(goals=_checked(goals))
        self._trail: deque[tuple[float, float]] = deque(maxlen=TRAIL_LENGTH)
        # Guards the scene and what the page does not know yet.
        self._lock = threading.Lock()
        self._news: dict[str, Any] = {}
        self._new_trail: list[float] = []
        self._new_scan: bytes | None = None
        # What the page was told last, and when.
        self._told: tuple[tuple[float, ...], bytes] = ((), b'')
        self._told_at = self._worded_at = 0.0
        self._words_due = False
        self._node: Any = None
        # The topics on which something has come since it subscribed.
        self._heard: set[str] = set()
        self._entities: list[tuple[str, Any]] = []
        self._canvas: _Canvas | None = None
        if settings.audience().live:
            self._canvas = _Canvas()
            self._canvas.on_msg(self._on_message)
        replace_earlier(_live, self)
        self._subscribe()

    # -- for cells ------------------------------------------------------------------------------

    @property
    def text(self) -> str:
        """What there is to see, in words."""
        return self.scene.words() or (
            f'Nothing was heard on {self.odom} yet. Start a robot with lab.spin(lab.Turtlebot()).'
        )

    def close(self) -> None:
        """Listen no more. What is shown stays as it is."""
        _live.pop(self, None)
        self._unsubscribe()
        if self._canvas is not None:
            self._canvas.send({'closed': True})

    def __enter__(self) -> Arena:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return self.text

    def _repr_mimebundle_(self, **_: object) -> dict[str, Any]:
        if self in _live and self._canvas is None:
            self._subscribe()
        self._wait_for_first()
        with self._lock:
            self.scene.trail = list(self._trail)
            svg = to_svg(self.scene, self.text)
            bundle: dict[str, Any] = {'text/plain': self.text, 'image/svg+xml': svg}
        if self._canvas is None:
            # Nobody looks on, so it listens only as long as it takes to draw a picture.
            self._unsubscribe()
        else:
            shown: Any = self._canvas._repr_mimebundle_()
            bundle = {**(shown[0] if isinstance(shown, tuple) else shown or {}), **bundle}
        return bundle

    # -- ROS ------------------------------------------------------------------------------------

    def _subscribe(self) -> None:
        """Listen, on labkit's hidden node: a view is no part of the learner's graph."""
        from nav_msgs.msg import Odometry
        from rclpy.qos import QoSProfile, ReliabilityPolicy
        from sensor_msgs.msg import LaserScan

        if self._node is not None and self._node is runtime.helper:
            return
        self._heard.clear()
        self._node = node = runtime.helper
        assert node is not None
        # Best effort hears every publisher, whatever it offers.
        qos = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)  # type: ignore[no-untyped-call]
        self._entities = [
            (
                'subscription',
                node.create_subscription(Odometry, self.odom, self._on_odometry, qos),
            ),
            ('subscription', node.create_subscription(LaserScan, self.scan, self._on_scan, qos)),
        ]
        if self._canvas is not None:
            self._entities.append(('timer', node.create_timer(1 / FRAME_RATE, self._push)))

    def _unsubscribe(self) -> None:
        if self._node is not None and self._node is runtime.helper:
            for kind, entity in self._entities:
                getattr(self._node, f'destroy_{kind}')(entity)
        self._node, self._entities = None, []

    def _wait_for_first(self) -> None:
        """Give topics that are published a moment to be heard, so that there is a picture."""
        if self._node is None or self._node is not runtime.helper:
            return
        count = runtime.helper.count_publishers

        def heard() -> bool:
            return all(
                topic in self._heard or count(topic) == 0 for topic in (self.odom, self.scan)
            )

        runtime.wait(heard, FIRST_SEC)

    def _on_odometry(self, message: Any) -> None:
        position, turn = message.pose.pose.position, message.pose.pose.orientation
        yaw = yaw_from_quaternion(turn.x, turn.y, turn.z, turn.w)
        speeds = message.twist.twist
        numbers = (position.x, position.y, yaw, speeds.linear.x, speeds.angular.z)
        if not all(map(math.isfinite, numbers)):
            return
        point = (position.x, position.y)
        self._heard.add(self.odom)
        with self._lock:
            self.scene.pose, self.scene.twist = Pose(*numbers[:3]), Twist2(*numbers[3:])
            if numbers != self._told[0] or time.monotonic() - self._told_at > STANDING_SEC:
                self._news['pose'] = numbers
            way = math.dist(self._trail[-1], point) if self._trail else math.inf
            if way > JUMP:
                # The robot was put there: its path begins anew.
                self._trail.clear()
                self._new_trail.clear()
                self._news['lifted'] = True
            if way >= TRAIL_STEP:
                self._trail.append(point)
                self._new_trail += point

    def _on_scan(self, message: Any) -> None:
        ranges = np.array(message.ranges, dtype=np.float64)
        # REP 117: +inf is nothing, -inf too near. Some drivers write 0 for nothing.
        good = np.isfinite(ranges) & (ranges >= message.range_min) & (ranges <= message.range_max)
        ranges[~good] = np.nan
        angles = message.angle_min + message.angle_increment * np.arange(len(ranges))
        with self._lock:
            pose = self.scene.pose
            if pose is None:
                return
            self._heard.add(self.scan)
            x = pose.x + BURGER.scan_x * math.cos(pose.yaw) + ranges * np.cos(pose.yaw + angles)
            y = pose.y + BURGER.scan_x * math.sin(pose.yaw) + ranges * np.sin(pose.yaw + angles)
            ends = np.stack([x, y], axis=1)
            self.scene.scan = [
                (end[0], end[1]) if end[0] == end[0] else None for end in ends.tolist()
            ]
            self.scene.reach, self.scene.nearest = float(message.range_max), None
            if good.any():
                beam = int(np.nanargmin(ranges))
                self.scene.nearest = float(ranges[beam]), wrap_angle(float(angles[beam]))
            numbers = ends.astype('<f4').tobytes()
            if numbers != self._told[1]:
                self._new_scan = numbers

    # -- the page -------------------------------------------------------------------------------

    def _on_message(self, _: object, content: dict[str, Any], __: object) -> None:
        """The page says that somebody sees the canvas, or that nobody does any more."""
        if content.get('view') == 'gone':
            self._unsubscribe()
        elif content.get('view') == 'seen' and self in _live:
            if runtime.started:
                self._subscribe()
            self._send(everything=True)

    def _push(self) -> None:
        """Tell the page what is new, if anything is."""
        words = self._words_due and time.monotonic() - self._worded_at >= WORDS_SEC
        if self._news or self._new_trail or self._new_scan or words:
            self._send()

    def _send(self, *, everything: bool = False) -> None:
        if self._canvas is None:
            return
        with self._lock:
            if everything:
                self._gather_everything()
            news, scan = {**self._news, 'trail': self._new_trail}, self._new_scan
            self._told = (news.get('pose', self._told[0]), scan or self._told[1])
            self._told_at = now = time.monotonic()
            self._words_due = everything or now - self._worded_at < WORDS_SEC
            if everything or not self._words_due:
                self._worded_at, news['text'] = now, self.text
            self._news, self._new_trail, self._new_scan = {}, [], None
        self._canvas.send(news, [scan] if scan is not None else None)

    def _gather_everything(self) -> None:
        """Let the next message tell all that is known, for a page that has just been opened."""
        scene = self.scene
        self._news = {'lifted': True, 'goals': scene.goals, 'topic': self.odom}
        self._new_trail = [number for point in self._trail for number in point]
        self._new_scan = self._new_scan or self._told[1] or None
        if scene.pose is not None:
            self._news['pose'] = (*scene.pose, *scene.twist)


def arena(
    *,
    odom: str = 'odom',
    scan: str = 'scan',
    namespace: str = '',
    goals: Iterable[tuple[float, float]] = (),
) -> Arena:
    """Show a live map of what a robot says on `/odom` and `/scan`.

    The robot, where it looks, the path that it has driven, and the walls as its scanner sees
    them. The map grows with what is seen; one square of the grid is 1 m.

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
