"""A live map of robots by their `/odom` and `/scan`: `lab.arena()`.

It is an ordinary subscriber of those topics, so it shows a robot in Gazebo or a real one as well.
On demand it draws frames as tf2 hears them, and all in a frame of one's choice.
Python keeps a scene for each robot and describes it; a canvas in the page draws them. Where
widgets can't run, the scenes are a picture (`labkit.views.arena_picture`). A goal that is set on
the map is published, as RViz does.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from labkit.asking.delivery import wait_until_found
from labkit.background.nodes import node_exists
from labkit.errors import LabError, quoted
from labkit.sim.kinematics import Pose
from labkit.views import dock
from labkit.views.arena_frames import ArenaFrames
from labkit.views.arena_picture import Axes, Scene, seen_from, to_svg
from labkit.views.arena_robot import MappedRobot
from labkit.views.feed import Feed, subscribed
from labkit.views.live import helper
from labkit.views.live_page import LivePage, Update
from labkit.views.timed_out import TimedOut

if TYPE_CHECKING:
    from nav_msgs.msg import Odometry
    from rclpy.publisher import Publisher
    from sensor_msgs.msg import LaserScan

__all__ = ['Arena', 'arena']

# The text changes no more often than this, s: a screen reader has to finish speaking it.
TEXT_SEC = 1.0
# How long a picture waits for the first message of a published topic, s.
FIRST_SEC = 3.0


class Arena(LivePage):
    """A live map around robots, to be shown in a cell; see `arena`."""

    _name = 'arena'
    # Only for changes without odometry: each odometry message is sent on as it arrives.
    _period = 0.25

    def __init__(
        self,
        *,
        odom: str,
        scan: str,
        namespace: str | None,
        goals: Iterable[tuple[float, float]],
        frames: Iterable[str],
        fixed_frame: str | None,
    ) -> None:
        self._topics = odom, scan
        names, fixed = _checked_frames(frames, fixed_frame)
        # None to draw all in the frame of the odometry, without tf2.
        self._frames = ArenaFrames(names, fixed, helper()) if names or fixed else None
        self._namespace = namespace
        # Points, and for one that was set on the map the heading there, rad.
        self._goals: list[tuple[float, ...]] = [*_checked(goals)]
        self._goal_publisher: Publisher | None = None
        self._robots: dict[str, MappedRobot] = {}
        # Why a robot that publishes is not heard.
        self._why = ''
        # First: a name of a topic may be invalid.
        robots = [self._new_robot(name) for name in self._names()]
        feeds = [feed for robot in robots for feed in robot.feeds]
        super().__init__([*feeds, *(self._frames.heard.feeds if self._frames else ())])
        # Changes that the page has not received yet.
        self._fresh = True
        self._text_sent_at = 0.0

    # -- for cells ------------------------------------------------------------------------------

    @property
    def scenes(self) -> dict[str, Scene]:
        """The latest scene of each robot, by namespace."""
        with self._lock:
            return {name: robot.current_scene() for name, robot in self._robots.items()}

    @property
    def text(self) -> str:
        """The scenes in words."""
        with self._lock:
            return '\n'.join([*self._told(), *self._unknown()])

    def _told(self) -> list[str]:
        """Return what is drawn, in words."""
        shown, axes = self._shown()
        told = [words for words in (scene.words() for scene in shown) if words]
        if told and self._frames is not None and self._frames.fixed:
            told.insert(0, f'All is told in the frame {self._frames.fixed}.')
        if not any(robot.scene.pose for robot in self._robots.values()):
            why = self._why or 'Start a robot with lab.spin(lab.Turtlebot()).'
            has_gone = any(robot.has_gone for robot in self._robots.values())
            nothing = f'Nothing was heard on {self._feeds[0].topic} yet.'
            told.append(f'{"The robot has gone." if has_gone else nothing} {why}')
        return [*told, *(one.words() for one in axes)]

    def __repr__(self) -> str:
        self._wait_for_first()
        return self.text

    def _static(self) -> dict[str, str]:
        self._open_early()
        self._wait_for_first()
        return self._stored_form()

    def _stored_form(self) -> dict[str, str]:
        with self._lock:
            text = self.text
            shown, axes = self._shown()
            fixed = self._frames.fixed if self._frames is not None else ''
            picture = to_svg(shown, text, axes=axes, frame=fixed)
            return {'text/plain': text, 'image/svg+xml': picture}

    # -- frames ---------------------------------------------------------------------------------

    def _shown(self) -> tuple[list[Scene], list[Axes]]:
        """Return the scenes as they are drawn, and axes; without what tf2 knows no place of."""
        frames, scenes = self._frames, list(self.scenes.values())
        if frames is None:
            return scenes, []
        shown = []
        for robot, scene in zip(self._robots.values(), scenes, strict=True):
            base = self._base(robot)
            if base is not None:
                at, place = base
                pose = robot.pose_at(at) if frames.fixed else scene.pose
                shown.append(seen_from(replace(scene, pose=pose), place))
        return shown, self._axes()

    def _base(self, robot: MappedRobot) -> tuple[float, Pose] | None:
        """Return when and where its odometry's frame is in the map; None if that is unknown."""
        assert self._frames is not None
        if not robot.frame:
            return 0.0, Pose()
        return self._frames.base(f'What {robot.feeds[0].topic} says', robot.frame)

    def _axes(self) -> list[Axes]:
        assert self._frames is not None
        odom = next((robot.frame for robot in self._robots.values() if robot.frame), '')
        target = self._frames.fixed or odom
        return self._frames.axes(target) if target else []

    def _unknown(self) -> list[str]:
        """Return what can't be drawn, with the reason."""
        return self._frames.told if self._frames is not None else []

    # -- ROS ------------------------------------------------------------------------------------

    def _wait_for_first(self) -> None:
        """Give published topics a moment to deliver, so that there is a picture."""
        if self._ended:
            return
        with self._lock:
            self._find_robots()
            robots = list(self._robots.values())
        heard = self._frames.heard if self._frames is not None else None
        if self._node is None:
            for robot in robots:
                robot.forget_heard()
            if heard is not None:
                heard.node = helper()
                heard.forget()

        def enough() -> bool:
            known = heard is None or heard.is_complete()
            return known and all(robot.is_heard for robot in robots)

        with subscribed(list(self._feeds), enough, timeout_sec=FIRST_SEC):
            odom = self._feeds[0]
            self._why = odom.silence() if odom.publishers else ''

    def _close(self) -> None:
        with self._lock:
            publisher, self._goal_publisher = self._goal_publisher, None
            if publisher is not None and self._node is not None and node_exists(self._node):
                self._node.destroy_publisher(publisher)
            super()._close()

    def _open(self) -> None:
        with self._lock:
            if self._frames is not None and self._node is None:
                self._frames.heard.begin()
            super()._open()

    def _tick(self) -> None:
        if self._frames is not None:
            self._frames.heard.follow_publishers()
        self._find_robots()
        super()._tick()

    def _find_robots(self) -> None:
        """Put robots on the map that have appeared, and take those from it that have gone."""
        names = self._names()
        if names and '' not in names and '' in self._robots and not self._robots[''].scene.pose:
            # It stood for one that was to come.
            for feed in self._robots.pop('').feeds:
                feed.close()
                self._feeds.remove(feed)
        for name in names:
            if name not in self._robots:
                feeds = self._new_robot(name).feeds
                self._feeds += feeds
                if self._node is not None:
                    for feed in feeds:
                        feed.open(self._node)
        # Last: the page is told before one that has gone is left out here.
        for robot in self._robots.values():
            if robot.scene.pose and not helper().count_publishers(robot.feeds[0].topic):
                robot.forget()

    def _names(self) -> list[str]:
        """Return the namespaces of the robots; '' for one that is to come if there are none."""
        if self._namespace is not None or any(topic.startswith('/') for topic in self._topics):
            return [(self._namespace or '').strip('/')]
        end, node = f'/{self._topics[0]}', helper()
        found = [
            topic.removesuffix(end).strip('/')
            for topic, types in node.get_topic_names_and_types()
            if topic.endswith(end)
            and 'nav_msgs/msg/Odometry' in types
            and node.count_publishers(topic)
        ]
        return sorted(found) or ([] if self._robots else [''])

    def _new_robot(self, name: str) -> MappedRobot:
        from nav_msgs.msg import Odometry
        from rclpy.qos import QoSProfile, ReliabilityPolicy
        from sensor_msgs.msg import LaserScan

        robot = MappedRobot(name, self._goals)
        robot.frames = self._frames

        def on_odometry(message: Odometry) -> None:
            with self._lock:
                if robot.take_odometry(message):
                    self._text_sent_at = 0.0  # announce a bump immediately
                # What is turned by tf2 can't be foretold in the page.
                news = self._frames is not None or robot.is_news(self._sent_at)
                if self._node is not None and news:
                    self._send()

        def on_scan(message: LaserScan) -> None:
            with self._lock:
                robot.take_scan(message)

        # Best effort matches every publisher.
        qos = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)  # type: ignore[no-untyped-call]
        odom, scan = (_full_name(topic, name) for topic in self._topics)
        robot.timed_out = TimedOut(odom, helper())
        robot.feeds = [
            Feed(odom, helper(), on_odometry, msg_type=Odometry, qos_profile=qos),
            Feed(scan, helper(), on_scan, msg_type=LaserScan, qos_profile=qos),
            robot.timed_out,
        ]
        # In this order they have their colours.
        self._robots = dict(sorted({**self._robots, name: robot}.items()))
        for one in self._robots.values():
            one.others = [other for other in self._robots.values() if other is not one]
        return robot

    # -- the page -------------------------------------------------------------------------------

    def _handle_request(self, content: dict[str, Any]) -> None:
        """Handle a goal that is to be set, one that is set, or the wish for a panel."""
        goal = content.get('goal')
        if content.get('aim'):
            self._publisher_of_goals()
        elif content.get('dock'):
            dock.show_cell(self)
        elif isinstance(goal, list) and len(goal) == 3 and all(map(_is_finite, goal)):
            self._set_goal(*map(float, goal))

    def _publisher_of_goals(self) -> Publisher:
        """Return the publisher of goals, made now if there is none."""
        from geometry_msgs.msg import PoseStamped

        publisher, node = self._goal_publisher, helper()
        if publisher is None or publisher not in node.publishers:
            space = next(iter(self._robots)) if len(self._robots) == 1 else self._namespace or ''
            publisher = node.create_publisher(PoseStamped, _full_name('goal_pose', space), 10)
            self._goal_publisher = publisher
        return publisher

    def _set_goal(self, x: float, y: float, yaw: float) -> None:
        """Mark a goal on the map and publish it, when all who listen have found the publisher."""
        from geometry_msgs.msg import PoseStamped

        publisher, node = self._publisher_of_goals(), helper()
        self._goals = [(x, y, yaw)]
        for robot in self._robots.values():
            robot.scene.goals = [(x, y)]
        message = PoseStamped()
        message.header.stamp = node.get_clock().now().to_msg()
        message.header.frame_id = next(
            (robot.frame for robot in self._robots.values() if robot.frame), 'odom'
        )
        message.pose.position.x, message.pose.position.y = x, y
        message.pose.orientation.z, message.pose.orientation.w = (
            math.sin(yaw / 2),
            math.cos(yaw / 2),
        )

        def publish() -> None:
            wait_until_found(node, [publisher])
            with self._lock:
                if self._goal_publisher is publisher and node_exists(node):
                    publisher.publish(message)

        threading.Thread(target=publish, name='labkit goal', daemon=True).start()

    def _update(self, everything: bool) -> Update:
        now = time.monotonic()
        robots, buffers = {}, []
        for name, robot in self._robots.items():
            base = self._base(robot) if self._frames is not None else None
            pose = robot.pose_at(base[0]) if base is not None and self._is_turned() else None
            changes, parts = robot.update(everything, pose)
            if changes:
                robots[name] = changes
                buffers += parts
        state: dict[str, object] = {'goals': self._goals, **self._frames_state()}
        if everything or now - self._text_sent_at >= TEXT_SEC:
            self._text_sent_at = now
            # One that is latched is silent as a rule.
            of_frames = self._frames.heard.feeds if self._frames is not None else []
            silences = (feed.silence() for feed in self._feeds if feed not in of_frames)
            why = next(filter(None, silences), '') or ' '.join(self._unknown())
            state |= {'text': '\n'.join(self._told()), 'note': why}
        changes = self._changes(state)
        if robots:
            changes['robots'] = robots
        if everything:
            # Scroll to the view only when its cell was just run.
            changes['fresh'] = self._fresh
            self._fresh = False
        return changes, buffers

    def _is_turned(self) -> bool:
        return self._frames is not None and bool(self._frames.fixed)

    def _frames_state(self) -> dict[str, object]:
        """Return what the page draws by tf2."""
        frames = self._frames
        if frames is None:
            return {}
        bases = {name: self._base(robot) for name, robot in self._robots.items()}
        return {
            'fixed': frames.fixed,
            'bases': {name: base and _short(base[1]) for name, base in bases.items()},
            'axes': [
                [
                    one.name,
                    _short(one.origin),
                    {axis: _short(tip) for axis, tip in one.tips.items()},
                ]
                for one in self._axes()
            ],
        }


def _short(numbers: Iterable[float]) -> list[float]:
    return [round(number, 5) for number in numbers]


def arena(
    *,
    odom: str = 'odom',
    scan: str = 'scan',
    namespace: str | None = None,
    goals: Iterable[tuple[float, float]] = (),
    frames: Iterable[str] = (),
    fixed_frame: str | None = None,
) -> Arena:
    """Show a live map of the `/odom` and `/scan` of robots.

    The map shows each robot, its heading, the path it has driven, and the walls as its scanner
    sees them, all in the frame of the odometry. Walls stay on the map; bumps are marked. Mouse,
    keys and buttons zoom and move the map. If the same cell shows `lab.teleop()`, map and keys are
    side by side. The button Goal publishes where one clicks as `geometry_msgs/msg/PoseStamped` on
    `goal_pose`, as RViz does; the button Dock is `lab.dock()`.

    With `frames` or `fixed_frame` it also hears `/tf` and `/tf_static`, and draws scans where tf2
    says that they were taken. What tf2 does not know is left out, and named with its reason.

    Args:
        odom: Topic with the robot's `nav_msgs/msg/Odometry`.
        scan: Topic with its `sensor_msgs/msg/LaserScan`.
        namespace: One of several robots: `'robot1'` makes these `/robot1/odom` and so on. By
            default all robots are on the map, as soon as they publish their odometry.
        goals: Points (x, y) to be marked, m, in the frame of the odometry.
        frames: Names of frames whose axes are drawn, such as `['odom', 'base_scan']`.
        fixed_frame: The frame that stands still; by default that of the odometry. In `base_link`
            the world turns round the robot.

    Returns:
        A map in a cell, text for `print()`. `.close()` ends it.

    Raises:
        LabError: A goal is not a pair of numbers, or a frame no name.
        ImportError: Frames are asked for, and the type of transforms can't be built here.
    """
    return Arena(
        odom=odom,
        scan=scan,
        namespace=namespace,
        goals=goals,
        frames=frames,
        fixed_frame=fixed_frame,
    )


def _checked_frames(frames: Iterable[str], fixed: str | None) -> tuple[list[str], str]:
    """Return names of frames, and the fixed one, '' without one; tf2 knows none with a slash."""
    names = [] if isinstance(frames, str) else list(frames)
    every = [*names, *([] if fixed is None else [fixed])]
    if isinstance(frames, str) or not all(isinstance(name, str) and name for name in every):
        raise LabError(
            f'frames is a list of names, and fixed_frame a name, but they are {quoted(frames)} '
            f'and {quoted(fixed)}.',
            todo="Write them like this: lab.arena(frames=['odom'], fixed_frame='base_link')",
        )
    return names, fixed or ''


def _is_finite(value: object) -> bool:
    return isinstance(value, (int, float)) and math.isfinite(value)


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
        f'goals must be pairs of numbers, in metres, but they are {quoted(goals)}.',
        todo='Write them like this: lab.arena(goals=[(1.0, 0.5)])',
    )
