"""A robot and its surroundings as a scene: told in words, and drawn as SVG without a browser.

`labkit.views.arena` shows it where widgets can't run, and checks show with it what a robot did.
An SVG inside a page or a file does not know the page's theme, so the picture has a ground of its
own.
"""

from __future__ import annotations

import html
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from labkit.sim.kinematics import BURGER, Pose, Twist2, wrap_angle

__all__ = ['Scene', 'bounds', 'joined', 'row', 'to_svg', 'two']

Point = tuple[float, float]

WIDTH, HEIGHT = 520, 400
# Pictures in a row are smaller, and as far apart, in pixels.
SMALL, GAP = 390, 20
# A number takes so much room, pixels.
EDGE = 40
# What is shown at least: so far around the origin, m.
LEAST = 1.0
# Neighbouring beams end on the same wall if their ends are not further apart than this many times
# what they would be on a wall that is looked at squarely.
SAME_WALL = 8.0
# Below this the robot stands, m/s and rad/s.
STILL = 0.005
# A TurtleBot3 Burger from above, m: back, front and half of the width of its body, and the width
# of a wheel. Source: ROBOTIS-GIT/turtlebot3_simulations, turtlebot3_gazebo/models/
# turtlebot3_burger/model.sdf: a box of 0.14 m, 0.032 m behind the axle (here it is a little
# narrower, to leave the wheels to be seen), wheels 0.018 m wide.
BODY, WHEEL_WIDTH = (-0.102, 0.038, 0.062), 0.018
# It is drawn no smaller than with this radius, pixels.
LEAST_PX = 13

_INK, _GRID, _WALL, _TRAIL, _ROBOT, _GOAL = (
    *('#424242', '#e0e0e0', '#37474f', '#1565c0', '#ef6c00', '#2e7d32'),
)
_BUMP = '#c62828'


@dataclass
class Scene:
    """What there is to see, in metres and radians.

    Attributes:
        pose: Where the robot is; None if it is not known.
        twist: How fast it moves.
        trail: Where it was, oldest first.
        scan: Ends of the beams of its scanner in their order; None where a beam met nothing.
        reach: How far the scanner sees; 0 if nothing was heard of it.
        nearest: Distance and direction of what is nearest, seen by the robot; None if nothing is.
        goals: Points to be marked.
        bump: Where it touches what has stopped it; None if nothing has.
        frame: The frame of all that in words; '' if it is that of the odometry.
    """

    pose: Pose | None = None
    twist: Twist2 = Twist2()  # noqa: RUF009 - it can't be changed
    trail: Sequence[Point] = ()
    scan: Sequence[Point | None] = ()
    reach: float = 0.0
    nearest: tuple[float, float] | None = None
    goals: Sequence[Point] = ()
    bump: Point | None = None
    frame: str = ''

    def words(self) -> str:
        """Return the scene in words; '' if nothing is known of a robot."""
        if self.pose is None:
            return ''
        degrees = round(math.degrees(self.pose.yaw)) + 0
        text = f'Robot at x = {two(self.pose.x)} m, y = {two(self.pose.y)} m, heading {degrees}°. '
        v, w = self.twist
        if abs(v) < STILL and abs(w) < STILL:
            text += 'It stands.'
            if self.bump is not None:
                x, y = self.bump
                angle = math.atan2(y - self.pose.y, x - self.pose.x) - self.pose.yaw
                text += f' It bumped into something, {_direction(wrap_angle(angle))}.'
        else:
            text += f'It drives at {two(v)} m/s and turns at {two(w)} rad/s.'
        if self.nearest is not None:
            distance, angle = self.nearest
            text += f' Nearest obstacle {two(distance)} m away, {_direction(angle)}.'
        elif self.reach:
            text += f' Nothing within {self.reach:.1f} m.'
        return text


def bounds(points: Iterable[Point], *, least: float = LEAST) -> tuple[float, float, float, float]:
    """Return what has to be shown: left, bottom, right, top, in steps of half a metre.

    Args:
        points: What must be inside.
        least: How much around the origin is shown in any case, m.
    """
    corners = [(-least, -least), (least, least)]
    xs, ys = zip(*[*corners, *points], strict=True)
    margin = 0.25
    low = [math.floor((min(values) - margin) * 2) / 2 for values in (xs, ys)]
    high = [math.ceil((max(values) + margin) * 2) / 2 for values in (xs, ys)]
    return low[0], low[1], high[0], high[1]


def joined(scan: Sequence[Point | None], eye: Point) -> list[tuple[Point, Point]]:
    """Return the lines between neighbouring beams that end on the same wall.

    Args:
        scan: Ends of the beams, None where a beam met nothing.
        eye: Where the scanner is.
    """
    lines = []
    for one, other in pairwise([*scan, *scan[:1]]):
        if one is None or other is None:
            continue
        apart = math.tau / len(scan) * min(math.dist(eye, one), math.dist(eye, other))
        if math.dist(one, other) <= SAME_WALL * apart:
            lines.append((one, other))
    return lines


def to_svg(scene: Scene, text: str = '', *, least: float = LEAST, font: int = 11) -> str:
    """Return a scene as an SVG picture.

    Args:
        scene: What to draw.
        text: The picture's text alternative; the scene's own words if empty.
        least: How much around the origin is shown in any case, m.
        font: Size of the letters, pixels.
    """
    seen = [point for point in scene.scan if point is not None]
    here = [(scene.pose.x, scene.pose.y)] if scene.pose is not None else []
    paper = _Paper(bounds([*seen, *scene.trail, *scene.goals, *here], least=least))
    paper.grid()
    if scene.pose is not None and seen:
        eye = _ahead(scene.pose, BURGER.scan_x)
        paper.fan(scene.scan, eye)
        paper.lines(joined(scene.scan, eye), _WALL, 2.5)
        paper.dots(seen, _WALL)
    paper.path(scene.trail, _TRAIL)
    if scene.pose is not None:
        paper.robot(scene.pose)
    # Above the robot, which may stand on one.
    for number, goal in enumerate(scene.goals, start=1):
        paper.goal(goal, str(number) if len(scene.goals) > 1 else '')
    if scene.bump is not None:
        paper.bump(scene.bump)
    if scene.frame:
        paper.name(scene.frame)
    text = html.escape(text or scene.words() or 'An empty map')
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
        f'width="{WIDTH}" height="{HEIGHT}" role="img" '
        f'font-family="sans-serif" font-size="{font}"><title>{text}</title>'
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>\n'
        + '\n'.join(paper.parts)
        + '\n</svg>'
    )


def row(scenes: Sequence[Scene], text: str) -> str:
    """Return scenes next to each other as one SVG picture, each as large as what happens in it.

    Args:
        scenes: What to draw.
        text: The picture's text alternative.
    """
    parts = [
        to_svg(scene, least=0.0, font=15).replace(
            '<svg ', f'<svg x="{number * (WIDTH + GAP)}" ', 1
        )
        for number, scene in enumerate(scenes)
    ]
    wide = len(scenes) * (WIDTH + GAP) - GAP
    scale = SMALL / WIDTH
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {HEIGHT}" '
        f'width="{wide * scale:.0f}" height="{HEIGHT * scale:.0f}" role="img">'
        f'<title>{html.escape(text)}</title>\n' + '\n'.join(parts) + '\n</svg>'
    )


class _Paper:
    """A sheet of which a rectangle of the floor is the middle."""

    def __init__(self, shown: tuple[float, float, float, float]) -> None:
        self.left, self.bottom, self.right, self.top = shown
        wide, high = self.right - self.left, self.top - self.bottom
        self.scale = min(WIDTH / wide, HEIGHT / high)
        self._x0 = WIDTH / 2 - self.scale * (self.left + self.right) / 2
        self._y0 = HEIGHT / 2 + self.scale * (self.bottom + self.top) / 2
        self.parts: list[str] = []

    def at(self, point: Point) -> tuple[str, str]:
        # Tenths of a pixel: fine enough, and the same on every machine.
        x, y = self._x0 + self.scale * point[0], self._y0 - self.scale * point[1]
        return f'{x:.1f}', f'{y:.1f}'

    def grid(self) -> None:
        """Draw lines at whole metres, or nearer to each other, and say which ones they are."""
        wide = WIDTH / self.scale
        step = 0.2 if wide < 2.7 else 0.5 if wide < 3.9 else 1 if wide < 26 else 5
        for x in _multiples(step, (self.left + self.right) / 2, wide / 2):
            px, _ = self.at((x, 0))
            self._line(px, '0', px, str(HEIGHT), x == 0)
            # One that would be cut off at the right is left out.
            if float(px) < WIDTH - EDGE:
                self._label(float(px) + 3, HEIGHT - 4, f'{x:g} m' if x == 0 else f'{x:g}')
        for y in _multiples(step, (self.bottom + self.top) / 2, HEIGHT / self.scale / 2):
            _, py = self.at((0, y))
            self._line('0', py, str(WIDTH), py, y == 0)
            # The corner at the bottom is that of the labels along x.
            if float(py) < HEIGHT - 20:
                self._label(3, float(py) - 3, f'{y:g} m' if y == 0 else f'{y:g}')
        self._label(WIDTH - 14, float(self.at((0, 0))[1]) - 3, 'x')
        self._label(float(self.at((0, 0))[0]) - 12, 12, 'y')

    def name(self, frame: str) -> None:
        """Say whose the axes are."""
        self.parts.append(
            f'<text x="{WIDTH - 8}" y="20" fill="#424242" text-anchor="end" '
            f'stroke="#ffffff" stroke-width="4" paint-order="stroke">{html.escape(frame)}</text>'
        )

    def _line(self, x1: str, y1: str, x2: str, y2: str, is_axis: bool) -> None:
        colour = '#9e9e9e' if is_axis else _GRID
        self.parts.append(f'<path d="M{x1} {y1}L{x2} {y2}" stroke="{colour}"/>')

    def _label(self, x: float, y: float, text: str) -> None:
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" fill="#616161">{text}</text>')

    def lines(self, lines: Sequence[tuple[Point, Point]], colour: str, width: float) -> None:
        path = ''.join(f'M{" ".join(self.at(a))}L{" ".join(self.at(b))}' for a, b in lines)
        self.parts.append(f'<path d="{path}" stroke="{colour}" stroke-width="{width}"/>')

    def fan(self, scan: Sequence[Point | None], eye: Point) -> None:
        """Draw what the scanner sees: from its eye along the ends of its beams."""
        path = 'L'.join(' '.join(self.at(end or eye)) for end in scan)
        self.parts.append(f'<path d="M{path}Z" fill="{_TRAIL}" fill-opacity="0.08"/>')

    def dots(self, points: Sequence[Point], colour: str) -> None:
        # A line of no length with round ends is a dot.
        path = ''.join(f'M{" ".join(self.at(point))}h0' for point in points)
        self.parts.append(
            f'<path d="{path}" stroke="{colour}" stroke-width="4" stroke-linecap="round"/>'
        )

    def path(self, points: Sequence[Point], colour: str) -> None:
        if len(points) > 1:
            text = ' '.join(','.join(self.at(point)) for point in points)
            self.parts.append(
                f'<polyline points="{text}" fill="none" stroke="{colour}" stroke-width="2.5"/>'
            )

    def goal(self, point: Point, label: str) -> None:
        x, y = self.at(point)
        self.parts.append(
            f'<g stroke="{_GOAL}" stroke-width="2" fill="none"><circle cx="{x}" cy="{y}" r="8"/>'
            f'<path d="M{x} {y}m-12 0h24m-12 -12v24"/></g>'
        )
        if label:
            self.parts.append(
                f'<text x="{float(x) + 12:.1f}" y="{float(y) - 8:.1f}" fill="{_GOAL}" '
                f'font-weight="bold">{label}</text>'
            )

    def robot(self, pose: Pose) -> None:
        """Draw it from above: wheels, body, scanner, and a nose ahead; as in `map.js`."""
        scale = max(self.scale, LEAST_PX / BURGER.radius)
        x, y = self.at((pose.x, pose.y))

        def path(points: Sequence[Point]) -> str:
            return 'M' + 'L'.join(
                f'{scale * ahead:.1f} {-scale * left:.1f}' for ahead, left in points
            )

        wheel, beside = BURGER.wheel_radius, BURGER.wheel_separation / 2
        back, front, half = BODY
        sides = ''.join(path([(-wheel, side), (wheel, side)]) for side in (beside, -beside))
        body = path([(back, half), (front, half), (front, -half), (back, -half)])
        self.parts.append(
            f'<circle cx="{x}" cy="{y}" r="{scale * BURGER.radius:.1f}" fill="{_ROBOT}" '
            f'fill-opacity="0.18"/><g transform="translate({x} {y}) '
            f'rotate({-math.degrees(pose.yaw):.1f})">'
            f'<path d="{sides}" stroke="{_INK}" stroke-width="{scale * WHEEL_WIDTH:.1f}"/>'
            f'<path d="{body}Z" fill="#ffffff" stroke="{_INK}" stroke-width="2" '
            f'stroke-linejoin="round"/>'
            f'<path d="{path([(0.088, 0), (front, 0.04), (front, -0.04)])}Z" fill="{_ROBOT}"/>'
            f'<path d="{path([(BURGER.scan_x, 0)])}h0" stroke="{_INK}" '
            f'stroke-width="{scale * 0.07:.1f}" stroke-linecap="round"/></g>'
        )

    def bump(self, point: Point) -> None:
        """Draw a star where something is touched."""
        x, y = self.at(point)
        corners = ' '.join(
            f'{(6 if corner % 2 else 13) * math.cos(corner * math.pi / 8):.1f},'
            f'{(6 if corner % 2 else 13) * math.sin(corner * math.pi / 8):.1f}'
            for corner in range(16)
        )
        self.parts.append(
            f'<polygon transform="translate({x} {y})" points="{corners}" fill="{_BUMP}" '
            f'stroke="#ffffff"/>'
        )


def _multiples(step: float, middle: float, reach: float) -> list[float]:
    """Return all multiples of `step` that are no further than `reach` from `middle`."""
    first, last = math.ceil((middle - reach) / step), math.floor((middle + reach) / step)
    return [round(number * step, 6) for number in range(first, last + 1)]


def _ahead(pose: Pose, distance: float) -> Point:
    return pose.x + distance * math.cos(pose.yaw), pose.y + distance * math.sin(pose.yaw)


def two(number: float) -> str:
    """Return a number with two digits after the point, and no minus before a zero."""
    return f'{round(number, 2) + 0.0:.2f}'


def _direction(angle: float) -> str:
    degrees = round(math.degrees(angle))
    if abs(degrees) <= 5:
        return 'ahead'
    if abs(degrees) >= 175:
        return 'behind'
    return f'{abs(degrees)}° to the {"left" if degrees > 0 else "right"}'
