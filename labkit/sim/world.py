"""The robot's surroundings: walls, round posts, other robots. Contacts and laser scans."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from labkit.errors import LabError
from labkit.sim.kinematics import Motion, Pose, Twist2
from labkit.sim.rays import TOUCH, Convex, see_posts, see_walls
from labkit.sim.robots import BURGER, Robot

__all__ = ['Contact', 'Post', 'Wall', 'World', 'open_field', 'pillars', 'playground', 'room']

# Slower approach than this is rounding, m/s.
STILL = 1e-12
# Most iterations towards a contact. It converges in about 5; more means a graze.
MAX_STEPS = 1000
# Margin around a robot within which it remembers things, m.
AROUND = 0.3


class Wall(NamedTuple):
    """A thin straight wall from (x1, y1) to (x2, y2), m."""

    x1: float
    y1: float
    x2: float
    y2: float

    def away(self, x: float, y: float) -> tuple[float, float, float]:
        """Return the distance of (x, y) from the wall, m, and the direction away from it."""
        along_x, along_y = self.x2 - self.x1, self.y2 - self.y1
        share = ((x - self.x1) * along_x + (y - self.y1) * along_y) / (along_x**2 + along_y**2)
        share = min(max(share, 0.0), 1.0)
        off_x, off_y = x - self.x1 - share * along_x, y - self.y1 - share * along_y
        distance = math.hypot(off_x, off_y)
        return distance, off_x / (distance or 1.0), off_y / (distance or 1.0)


class Post(NamedTuple):
    """A round obstacle with its centre at (x, y), m."""

    x: float
    y: float
    radius: float

    def away(self, x: float, y: float) -> tuple[float, float, float]:
        """Return the distance of (x, y), negative inside, m, and the direction away from it."""
        off_x, off_y = x - self.x, y - self.y
        distance = math.hypot(off_x, off_y)
        return distance - self.radius, off_x / (distance or 1.0), off_y / (distance or 1.0)


class Contact(NamedTuple):
    """A contact of the robot.

    Attributes:
        time: Time, s.
        x: Point of contact, m.
        y: Point of contact, m.
        thing: What it touches: a `Wall`, or a `Post`, which may be another robot.
    """

    time: float
    x: float
    y: float
    thing: Wall | Post


class World:
    """Walls and posts, and the robots among them.

    Args:
        walls: Free-standing walls.
        posts: Round obstacles.
        corners: Corners of a convex room around everything, in order, m. Its sides are walls.
            Without corners the world has no outside.

    Attributes:
        corners: The corners of the room.
        walls: The walls, those of the room first.
        posts: The round obstacles.
        fixed: All walls and posts.
        robots: The robots in this world by name, as posts at their current positions. Robots in
            the same world see each other, and stop when they meet.
    """

    def __init__(
        self,
        walls: Iterable[Wall] = (),
        posts: Iterable[Post] = (),
        *,
        corners: Iterable[tuple[float, float]] = (),
    ) -> None:
        self.corners = tuple(corners)
        self._sides = _ring(self.corners)
        self.walls = (*self._sides, *(Wall(*wall) for wall in walls))
        self.posts = tuple(Post(*post) for post in posts)
        self.robots: dict[str, Post] = {}
        self.fixed: tuple[Wall | Post, ...] = (*self.walls, *self.posts)
        for thing in self.fixed:
            _check(thing)
        self._room = Convex(self.corners) if len(self.corners) > 2 else None
        self._lines = np.array(self.walls, dtype=float).reshape(-1, 4)
        self._rounds = np.array(self.posts, dtype=float).reshape(-1, 3)
        self._known: dict[str, _Surroundings] = {}

    def __repr__(self) -> str:
        return f'<World: {len(self.walls)} walls, {len(self.posts)} posts>'

    def things(self, but: str = '') -> list[Wall | Post]:
        """Return everything in the world, except the robot named `but`."""
        return [*self.fixed, *self._others(but)]

    def is_outside(self, x: float, y: float) -> bool:
        """Return whether (x, y), m, is outside the room."""
        # Following the sides, the inside is always on the same hand.
        turns = [
            (side.x2 - side.x1) * (y - side.y1) - (side.y2 - side.y1) * (x - side.x1)
            for side in self._sides
        ]
        return any(turn < 0 for turn in turns) and any(turn > 0 for turn in turns)

    def first_contact(
        self, motion: Motion, duration: float, radius: float, *, but: str = ''
    ) -> Contact | None:
        """Return the first contact of a moving disc.

        Args:
            motion: Motion of its centre.
            duration: Duration, s.
            radius: Radius of the disc, m.
            but: Name of a robot to leave out: the disc itself.

        Returns:
            The first contact, with its time from the start of the motion. None if the disc comes
            near nothing, or moves away from what it touches.
        """
        others = self._others(but)
        if not self.fixed and not others:
            return None
        x, y, _ = motion.start
        path = _Path(motion, motion.fastest(duration), duration)
        far = path.reach + radius + TOUCH
        first: Contact | None = None
        for thing in (*self._near(x, y, far, but), *others):
            if thing.away(x, y)[0] > far:
                continue
            time = _touch_time(path, thing, radius, first.time if first else duration)
            if time is not None:
                x_then, y_then, _ = motion.pose_at(time)
                distance, away_x, away_y = thing.away(x_then, y_then)
                touch_x, touch_y = x_then - distance * away_x, y_then - distance * away_y
                first = Contact(time, touch_x, touch_y, thing)
        return first

    def _others(self, but: str) -> list[Post]:
        if len(self.robots) == (but in self.robots):
            return []  # the usual case
        return [post for name, post in list(self.robots.items()) if name != but]

    def _near(self, x: float, y: float, distance: float, who: str) -> tuple[Wall | Post, ...]:
        """Return fixed things that may be within a distance of (x, y), from a robot's cache."""
        known = self._known.get(who, _Surroundings(x, y, 0.0, 0.0, ()))
        moved = math.hypot(x - known.x, y - known.y)
        if moved + distance <= known.free:
            return ()
        limit, near = known.limit - moved, known.near
        if distance > limit:
            limit = distance + AROUND
            near = tuple(thing for thing in self.fixed if thing.away(x, y)[0] <= limit)
        free = min((thing.away(x, y)[0] for thing in near), default=limit)
        self._known[who] = _Surroundings(x, y, min(free, limit), limit, near)
        return near

    def ranges(self, pose: Pose, *, robot: Robot = BURGER, but: str = '') -> NDArray[np.float64]:
        """Return the ranges of the robot's laser scanner, beam by beam to the left, m.

        Args:
            pose: The robot's pose.
            robot: The robot's dimensions.
            but: Name of a robot to leave out: the one with the scanner.

        Returns:
            Distances from the scanner, not clipped to its range; infinity where nothing is.
        """
        eye_x = pose.x + robot.scan_x * math.cos(pose.yaw)
        eye_y = pose.y + robot.scan_x * math.sin(pose.yaw)
        cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
        # The fan of beams, turned by the heading.
        rays = np.array(((cos, -sin), (sin, cos))) @ _fan(robot.scan_beams)
        nearest = self._see_walls(eye_x, eye_y, rays)
        others = self._others(but)
        rounds = np.vstack([self._rounds, others]) if others else self._rounds
        if len(rounds):
            np.minimum(nearest, see_posts(rounds - (eye_x, eye_y, 0.0), rays), out=nearest)
        return nearest

    def _see_walls(self, x: float, y: float, rays: NDArray[np.float64]) -> NDArray[np.float64]:
        nearest = self._room.see(np.array((x, y)), rays) if self._room else None
        lines: NDArray[np.float64] = self._lines
        if nearest is not None:
            lines = lines[len(self._sides) :]
        if nearest is None:
            nearest = np.full(rays.shape[1], math.inf)
        if len(lines):
            np.minimum(nearest, see_walls(lines - (x, y, x, y), rays), out=nearest)
        return nearest


class _Surroundings(NamedTuple):
    """A robot's cached knowledge of the fixed things around a place.

    Attributes:
        x: The place, m.
        y: The place, m.
        free: Distance within which there is nothing, m.
        limit: Distance within which it knows everything, m.
        near: The things within that distance.
    """

    x: float
    y: float
    free: float
    limit: float
    near: tuple[Wall | Post, ...]


@functools.cache
def _fan(count: int) -> NDArray[np.float64]:
    """Return the directions of a scanner's beams, relative to the x axis."""
    angles = np.arange(count) * (math.tau / count)
    return np.vstack((np.cos(angles), np.sin(angles)))


class _Path(NamedTuple):
    """A motion with its bounds, for the search for a contact.

    Attributes:
        fastest: Its greatest speeds.
        duration: Its duration, s.
    """

    motion: Motion
    fastest: Twist2
    duration: float

    @property
    def reach(self) -> float:
        """The greatest distance it can cover, m."""
        return self.fastest.v * self.duration

    def bend(self, share: float) -> float:
        """Return the greatest acceleration in a direction, m/s².

        Args:
            share: Cosine of the angle between the direction and the current heading.
        """
        # Along its path the disc speeds up, across its path it follows the curve.
        turn = self.fastest.w * self.duration
        along = abs(self.motion.acceleration.v) * min(1.0, abs(share) + turn)
        return along + self.fastest.v * self.fastest.w


def _touch_time(path: _Path, thing: Wall | Post, radius: float, until: float) -> float | None:
    """Return the time when the disc first touches a thing, None if not before `until`.

    Things are convex, so the gap g to one of them is a convex function of position. With g' its
    current rate of change and A the greatest acceleration towards it, the gap after h seconds is
    at least g + g' h - A h²/2. It is safe to advance to the zero of this bound; repeat from there.
    On a straight line this is Newton's method. Nothing is stepped over, however long the path.
    """
    motion = path.motion
    time = 0.0
    for _ in range(MAX_STEPS):
        pose = motion.pose_at(time)
        distance, away_x, away_y = thing.away(pose.x, pose.y)
        gap = distance - radius
        # Share of a movement along the heading that leads away from the thing.
        share = away_x * math.cos(pose.yaw) + away_y * math.sin(pose.yaw)
        rate = share * motion.twist_at(time).v
        if gap <= TOUCH:
            start = rate if abs(rate) > STILL else share * motion.acceleration.v
            if start < -STILL:
                return time
        # A disc that slides along a thing, or leaves it, may come closer by no more than TOUCH.
        time += _safe_step(max(gap, TOUCH), rate, path.bend(share))
        if time >= until:
            return None
    return time


def _safe_step(gap: float, rate: float, bend: float) -> float:
    """Return how long `gap + rate h - bend h²/2` stays positive, s."""
    root = math.sqrt(rate * rate + 2 * bend * gap)
    if rate < 0:
        return 2 * gap / (root - rate)
    return (rate + root) / bend if bend else math.inf


def _check(thing: Wall | Post) -> None:
    if not all(math.isfinite(number) for number in thing):
        raise LabError(f'All numbers of a wall or a post must be finite, but this is {thing!r}.')
    if isinstance(thing, Wall) and (thing.x1, thing.y1) == (thing.x2, thing.y2):
        raise LabError(
            f'A wall needs two different ends, but this is {thing!r}.',
            todo='For a round obstacle write Post(x, y, radius).',
        )
    if isinstance(thing, Post) and thing.radius <= 0:
        raise LabError(f'The radius of a post must be positive, but this is {thing!r}.')


def open_field() -> World:
    """Return an empty world."""
    return World()


def room(width: float = 5.0, height: float = 5.0, posts: Iterable[Post] = ()) -> World:
    """Return a room centred on the origin.

    Args:
        width: Size along x, m.
        height: Size along y, m.
        posts: Round obstacles in it.
    """
    x, y = width / 2, height / 2
    return World(posts=posts, corners=[(x, y), (-x, y), (-x, -y), (x, -y)])


def playground() -> World:
    """Return a room of 5 m by 5 m with posts in three of its corners.

    One metre around the origin is free, and no two views of the room are alike.
    """
    return room(posts=[Post(1.6, 1.6, 0.2), Post(-1.7, 1.3, 0.15), Post(-1.2, -1.7, 0.25)])


def pillars() -> World:
    """Return nine pillars within six walls, like the world that ROBOTIS ships for Gazebo.

    Source: ROBOTIS-GIT/turtlebot3_simulations, turtlebot3_gazebo/models/turtlebot3_world/
        model.sdf: pillars of radius 0.15 m, 1.1 m apart. Here the six walls are 2.5 m from the
        centre. x=-1.65, y=-0.55 is a good start for a robot.
    """
    far = 2.5 / math.cos(math.pi / 6)
    angles = [corner * math.tau / 6 for corner in range(6)]
    grid = (-1.1, 0.0, 1.1)
    return World(
        posts=[Post(x, y, 0.15) for x in grid for y in grid],
        corners=[(far * math.cos(angle), far * math.sin(angle)) for angle in angles],
    )


def _ring(corners: tuple[tuple[float, float], ...]) -> tuple[Wall, ...]:
    ends = zip(corners, corners[1:] + corners[:1], strict=True)
    return tuple(Wall(*one, *other) for one, other in ends)
