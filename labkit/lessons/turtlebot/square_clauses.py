"""What the check of the exercise square asks for."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, starmap, zip_longest
from typing import NoReturn

from labkit.exercises import Fail
from labkit.lessons.turtlebot.clauses import (
    SLEEP_TOLERANCE,
    DriveClause,
    look_at_time,
)
from labkit.lessons.turtlebot.drive import Drive, Point, Trial
from labkit.sim.kinematics import Motion, Pose, wrap_angle
from labkit.views.arena_picture import two

__all__ = ['Closes', 'Outline', 'Sides', 'draw', 'tell']

# How far it may be off a corner, m.
NEAR = 0.1
# As long as that a command counts, s.
STEP_SEC = 0.1
# What it turns while it drives is none of the turns on the spot, m/s; it may be so much, rad.
DRIVES = 0.05
CURVED = math.pi
# An unhurried drive: m/s along a side, and s for each turn with its pauses.
UNHURRIED, TURN_SEC = 0.2, 3.5


@dataclass(frozen=True)
class Outline:
    """The square that is to be driven.

    Attributes:
        side: The length of its sides, m.
        turn: Which way to turn at its corners, `'left'` or `'right'`.
    """

    side: float = 0.4
    turn: str = 'left'

    @property
    def corners(self) -> tuple[Point, ...]:
        """The corners, seen from the start, which is the first and the last: x ahead, m."""
        side = self.side
        across = side if self.turn == 'left' else -side
        return (0.0, 0.0), (side, 0.0), (side, across), (0.0, across), (0.0, 0.0)

    @property
    def seconds(self) -> float:
        """How long the drive may take, s."""
        return float(round(4 * (self.side / UNHURRIED + TURN_SEC)))


@dataclass(frozen=True)
class Sides(DriveClause):
    """It drives along the sides of a square, and turns at its corners."""

    outline: Outline = Outline()

    @property
    def text(self) -> str:
        """What is asked for."""
        return (
            f'drive four straight sides of {self.outline.side} m, and between them turn '
            f'90 degrees to the {self.outline.turn} on the spot (corners up to {NEAR} m off)'
        )

    def look(self, found: Drive) -> None:
        """Look at one drive."""
        if not found.commands:
            return
        corners = self.outline.corners
        path, near_enough = _path(found, corners), _near_enough(found, corners)
        after = 0
        for number, corner in enumerate(corners[1:], start=1):
            near = [
                i for i in range(after, len(path)) if math.dist(path[i], corner) <= near_enough
            ]
            if not near:
                _refuse_corner(found, path[after:], number, self.outline)
            after = near[0]
        off, outside = max((_off(point, corners), point) for point in path[: after + 1])
        if off > near_enough:
            raise Fail(
                'a way along the sides of the square',
                f'it came to ({two(outside[0])}, {two(outside[1])}), seen from the start',
                why='A side is longer than it should be, or it leaves the square on its way.',
                todo='Four times the same: a side, then a turn.',
            )
        curved = _turned_while_driving(found)
        if found.exact and curved > CURVED:
            raise Fail(
                'straight sides, and turns on the spot',
                f'it turned by {math.degrees(curved):.0f} degrees while it drove',
                why='It drives a curve, which only passes the corners.',
                todo='A command for a side has angular.z = 0.0, one for a turn linear.x = 0.0.',
            )


@dataclass(frozen=True)
class Closes(DriveClause):
    """It ends where it began."""

    outline: Outline = Outline()

    @property
    def text(self) -> str:
        """What is asked for."""
        return f'stop where you began (up to {NEAR} m off), within {self.outline.seconds:.0f} s'

    def look(self, found: Drive) -> None:
        """Look at one drive."""
        look_at_time(found, self.outline.seconds)
        if not found.commands or found.cut:
            return
        corners = self.outline.corners
        path = _path(found, corners)
        away, way = math.dist(path[-1], corners[-1]), sum(starmap(math.dist, pairwise(path)))
        # How many times as long as the sides of the square its way is.
        rounds = way / (4 * self.outline.side)
        if away <= _near_enough(found, corners) and rounds < 1.5:
            return
        raise Fail(
            'it ends where it began, after four sides',
            f'it ends {away:.2f} m away from there, after {way:.1f} m',
            why='It goes on after the fourth side.',
            todo='After the fourth side publish an empty Twist().',
        )


def _refuse_corner(found: Drive, path: Sequence[Point], number: int, outline: Outline) -> NoReturn:
    if found.cut:
        look_at_time(found, outline.seconds)
    corner = outline.corners[number]
    x, y = min(path, key=lambda point: math.dist(point, corner))
    mirrored = (corner[0], -corner[1])
    if number == 2 and any(math.dist(point, mirrored) <= NEAR for point in path):
        if outline.turn == 'left':
            why = 'It turns to the right. A positive angular.z turns to the left.'
            todo = 'msg.angular.z above 0'
        else:
            why = 'It turns to the left. A negative angular.z turns to the right.'
            todo = 'msg.angular.z below 0'
    elif not any(command.v for command in found.moving):
        why, todo = 'No command says to drive ahead.', 'msg.linear.x = 0.2'
    elif number == 1:
        why, todo = (
            'The first side has another length, or it did not drive straight on.',
            f'Way = speed times time: 0.2 m/s for {outline.side / 0.2:g} s, which is '
            f'{outline.side / 0.02:.0f} steps of 0.1 s.',
        )
    elif number == 4:
        why, todo = (
            'The fourth side is missing, or the corners are no right angles.',
            'Four times the same: a side, then a turn.',
        )
    else:
        why, todo = (
            'The turn is no right angle, or the side has another length. A right angle is '
            '1.57 rad.',
            'Angle = turning rate times time: 1.57 rad/s for 1 s, which is 10 steps of 0.1 s.',
        )
    corners = ', '.join(f'({x:g}, {y:g})' for x, y in outline.corners[1:])
    raise Fail(
        f'corners at {corners} m, seen from the start',
        f'it came no nearer to corner {number}, ({corner[0]:g}, {corner[1]:g}), than '
        f'({two(x)}, {two(y)})' + (', and was still driving' if found.cut else ''),
        why=why,
        todo=todo,
    )


def _path(found: Drive, corners: Sequence[Point]) -> list[Point]:
    """Return the path that counts, seen from the start.

    In real time a busy computer holds commands up, and the robot drives and turns too far. Then
    what was commanded counts, if the node means to send it ten times a second.
    """
    if found.exact or abs(found.meant / STEP_SEC - 1.0) > SLEEP_TOLERANCE:
        return _from_start(found)
    commanded = _as_commanded(found, longest=STEP_SEC + found.margin)
    return commanded if _is_along(commanded, corners) else _from_start(found)


def _near_enough(found: Drive, corners: Sequence[Point]) -> float:
    """Return how far it may be off, m; in real time twice as far, see `_path`."""
    return NEAR if found.exact or not _is_along(_as_commanded(found), corners) else 2 * NEAR


def _as_commanded(found: Drive, longest: float = math.inf) -> list[Point]:
    """Return the path of a robot that obeys each command for 0.1 s, seen from the start.

    Args:
        found: The drive.
        longest: After which time a command was meant to be obeyed for longer, s.
    """
    pose = Pose(0.0, 0.0, 0.0)
    path = [(pose.x, pose.y)]
    for command, later in zip_longest(found.commands, found.commands[1:]):
        gap = later.at - command.at if later is not None else 0.0
        pose = Motion(pose, command.twist).pose_at(gap if gap > longest else STEP_SEC)
        path.append((pose.x, pose.y))
    return path


def _is_along(path: Sequence[Point], corners: Sequence[Point]) -> bool:
    """Tell whether a path comes by all corners, in their order, and ends at the last one."""
    after = 0
    for corner in corners[1:]:
        near = [i for i in range(after, len(path)) if math.dist(path[i], corner) <= NEAR]
        if not near:
            return False
        after = near[0]
    return math.dist(path[-1], corners[-1]) <= NEAR


def _off(point: Point, corners: Sequence[Point]) -> float:
    """Return how far a point is from the nearest side, m."""
    return min(_away(point, *side) for side in pairwise(corners))


def _away(point: Point, one: Point, other: Point) -> float:
    """Return how far a point is from a line between two others along an axis, m."""
    (x, y), xs, ys = point, *(sorted(pair) for pair in zip(one, other, strict=True))
    return math.hypot(x - min(max(x, xs[0]), xs[1]), y - min(max(y, ys[0]), ys[1]))


def _turned_while_driving(found: Drive) -> float:
    """Return by how much it turned while it drove, rad."""
    total = 0.0
    for (at, one), (later, other) in pairwise(found.poses):
        if math.dist(one[:2], other[:2]) > DRIVES * (later - at):
            total += abs(wrap_angle(other.yaw - one.yaw))
    return total


def _from_start(found: Drive) -> list[Point]:
    """Return the path as the robot saw it at the start."""
    return [found.told(pose)[:2] for _, pose in found.poses]


def draw(outline: Outline) -> list[Trial]:
    """Return two drives. They are not along an axis: a square is one wherever it begins."""
    starts = [
        (random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), random.uniform(-3, 3))
        for _ in range(2)
    ]
    return [Trial(start, goals=outline.corners[1:], from_start=True) for start in starts]


def tell(drives: Sequence[Drive]) -> str:
    """Say what was seen."""
    found = drives[0]
    away = math.dist(found.end[:2], found.start[:2])
    return f'A square of {found.way():.2f} m, closed to {away:.2f} m, in {found.duration:.0f} s.'
