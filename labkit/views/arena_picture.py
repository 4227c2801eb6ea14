"""A robot and its surroundings, in words and as SVG without a browser.

`labkit.views.arena` shows it where widgets can't run, and checks use it to show what a robot
did. An SVG in a page or a file can't follow the page's theme, so it has its own background.
"""

from __future__ import annotations

import html
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from labkit.sim.kinematics import Pose, Twist2, wrap_angle
from labkit.sim.robots import BURGER

__all__ = ['Axes', 'Scene', 'bounds', 'joined', 'row', 'seen_from', 'to_svg', 'two']

Point = tuple[float, float]

WIDTH, HEIGHT = 520, 400
# Size of pictures in a row, and the gap between them, px.
SMALL, GAP = 390, 20
# Room for a number, px.
EDGE = 40
# Least distance around the origin that is shown, m.
LEAST = 1.0
# Neighbouring beams hit the same wall if their ends are no further apart than this many times the
# distance on a wall seen head-on.
SAME_WALL = 8.0
# Below this the robot is at rest, m/s and rad/s.
STILL = 0.005
# A TurtleBot3 Burger from above, m: back, front and half of the width of its body, and the width
# of a wheel. Source: ROBOTIS-GIT/turtlebot3_simulations, turtlebot3_gazebo/models/
# turtlebot3_burger/model.sdf: a box of 0.14 m, 0.032 m behind the axle (here it is a little
# narrower, to leave the wheels to be seen), wheels 0.018 m wide.
BODY, WHEEL_WIDTH = (-0.102, 0.038, 0.062), 0.018
# Least radius at which the robot is drawn, px.
LEAST_PX = 13

_INK, _GRID, _WALL, _TRAIL, _ROBOT, _GOAL = (
    *('#424242', '#e0e0e0', '#37474f', '#1565c0', '#ef6c00', '#2e7d32'),
)
_BUMP = '#c62828'
# Of several robots on one map, and of their trails; as in `map.js`.
_SEVERAL = (_ROBOT, '#1976d2', '#8e24aa', '#2e7d32')
# The axes of a frame, as in RViz; each has its letter, too. Their length, m, and the least, px.
_AXES = {'x': '#c62828', 'y': '#2e7d32', 'z': '#1565c0'}
AXIS, AXIS_PX = 0.25, 40
# Room for the name of a frame, px.
NAME_PX = 120, 14


@dataclass(frozen=True)
class Axes:
    """The axes of a frame on the map.

    Attributes:
        name: Name of the frame.
        origin: Its place, m.
        tips: The directions of its axes, of length 1 if they are level, by their letters.
    """

    name: str
    origin: Point
    tips: Mapping[str, Point]

    def words(self) -> str:
        """Return where it is, in words."""
        x, y = (two(number) for number in self.origin)
        words = f'Frame {self.name} at x = {x} m, y = {y} m'
        if 'x' not in self.tips:
            return f'{words}.'
        ahead, left = self.tips['x']
        return f'{words}, its x axis at {round(math.degrees(math.atan2(left, ahead))) + 0}°.'


@dataclass
class Scene:
    """A robot and its surroundings, in metres and radians.

    Attributes:
        pose: Pose of the robot; None if unknown.
        twist: Velocity of the robot.
        trail: Past positions, oldest first.
        scan: Ends of the scanner's beams, in order; None where a beam hit nothing.
        reach: Range of the scanner; 0 before the first scan.
        nearest: Distance and direction of the nearest obstacle; None if there is none.
        goals: Points to mark.
        bump: Point where an obstacle has stopped the robot; None if none has.
        why: Why it stands, if it says so.
        frame: Name of the frame; '' for the frame of the odometry.
        name: Name of the robot, '' for the only one.
        eye: Place of the scanner; None where it is on a Burger.
    """

    pose: Pose | None = None
    twist: Twist2 = Twist2()  # noqa: RUF009 - it can't be changed
    trail: Sequence[Point] = ()
    scan: Sequence[Point | None] = ()
    reach: float = 0.0
    nearest: tuple[float, float] | None = None
    goals: Sequence[Point] = ()
    bump: Point | None = None
    why: str = ''
    frame: str = ''
    name: str = ''
    eye: Point | None = None

    def words(self) -> str:
        """Return the scene in words; '' without a pose."""
        if self.pose is None:
            return ''
        degrees = round(math.degrees(self.pose.yaw)) + 0
        x, y = two(self.pose.x), two(self.pose.y)
        text = f'{self.name or "Robot"} at x = {x} m, y = {y} m, heading {degrees}°. '
        v, w = self.twist
        if abs(v) < STILL and abs(w) < STILL:
            text += f'It stands: {self.why}.' if self.why else 'It stands.'
            if self.bump is not None:
                ahead, left = self.bump[0] - self.pose.x, self.bump[1] - self.pose.y
                angle = math.atan2(left, ahead) - self.pose.yaw
                text += f' It bumped into something, {_direction(wrap_angle(angle))}.'
        else:
            text += f'It drives at {two(v)} m/s and turns at {two(w)} rad/s.'
        if self.nearest is not None:
            distance, angle = self.nearest
            text += f' Nearest obstacle {two(distance)} m away, {_direction(angle)}.'
        elif self.reach:
            text += f' Nothing within {self.reach:.1f} m.'
        return text


def seen_from(scene: Scene, base: Pose) -> Scene:
    """Return a scene in another frame.

    Args:
        scene: The scene.
        base: Where its frame is in the other one.
    """
    cos, sin = math.cos(base.yaw), math.sin(base.yaw)

    def moved(point: Point) -> Point:
        x, y = point
        return base.x + cos * x - sin * y, base.y + sin * x + cos * y

    def all_moved(points: Iterable[Point]) -> list[Point]:
        return [moved(point) for point in points]

    pose = scene.pose
    return replace(
        scene,
        pose=pose and Pose(*moved(pose[:2]), wrap_angle(pose.yaw + base.yaw)),
        trail=all_moved(scene.trail),
        scan=[end and moved(end) for end in scene.scan],
        goals=all_moved(scene.goals),
        bump=scene.bump and moved(scene.bump),
        eye=scene.eye and moved(scene.eye),
    )


def bounds(points: Iterable[Point], *, least: float = LEAST) -> tuple[float, float, float, float]:
    """Return the area to show: left, bottom, right, top, in steps of half a metre.

    Args:
        points: Points that must be inside.
        least: Least distance around the origin that is shown, m.
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
        scan: Ends of the beams, None where a beam hit nothing.
        eye: Position of the scanner.
    """
    lines = []
    for one, other in pairwise([*scan, *scan[:1]]):
        if one is None or other is None:
            continue
        apart = math.tau / len(scan) * min(math.dist(eye, one), math.dist(eye, other))
        if math.dist(one, other) <= SAME_WALL * apart:
            lines.append((one, other))
    return lines


def to_svg(
    scenes: Scene | Sequence[Scene],
    text: str = '',
    *,
    least: float = LEAST,
    font: int = 11,
    axes: Sequence[Axes] = (),
    frame: str = '',
) -> str:
    """Return robots and their surroundings as an SVG picture.

    Args:
        scenes: The scene of a robot, or those of several on one map, with the same goals.
        text: Text alternative; by default the scenes in words.
        least: Least distance around the origin that is shown, m.
        font: Font size, px.
        axes: Axes of frames to draw.
        frame: Name of the frame; by default that of the first scene.
    """
    scenes = [scenes] if isinstance(scenes, Scene) else scenes
    first = scenes[0] if scenes else Scene()
    points = [*_points(scenes), *(one.origin for one in axes)]
    paper = _Paper(bounds(points, least=least))
    paper.grid()
    for scene in scenes:
        if scene.pose is not None:
            paper.scan(scene.scan, scene.pose, scene.eye)
    colours = [(_TRAIL, _ROBOT)] if len(scenes) == 1 else [(one, one) for one in _SEVERAL]
    for number, scene in enumerate(scenes):
        paper.path(scene.trail, colours[number % len(colours)][0])
    for number, scene in enumerate(scenes):
        if scene.pose is not None:
            paper.robot(scene.pose, colours[number % len(colours)][1], scene.name)
    # On top of the robots, which may stand on one.
    for number, goal in enumerate(first.goals, start=1):
        paper.goal(goal, str(number) if len(first.goals) > 1 else '')
    for scene in scenes:
        if scene.bump is not None:
            paper.bump(scene.bump)
    paper.axes(axes)
    if frame or first.frame:
        paper.name(frame or first.frame)
    words = '\n'.join(filter(None, (scene.words() for scene in scenes)))
    text = html.escape(text or words or 'An empty map')
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
        f'width="{WIDTH}" height="{HEIGHT}" role="img" '
        f'font-family="sans-serif" font-size="{font}"><title>{text}</title>'
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>\n'
        + '\n'.join(paper.parts)
        + '\n</svg>'
    )


def _points(scenes: Sequence[Scene]) -> list[Point]:
    """Return what has to be on the map."""
    points: list[Point] = []
    for scene in scenes:
        points += [end for end in scene.scan if end is not None]
        points += [*scene.trail, *scene.goals]
        points += [] if scene.pose is None else [(scene.pose.x, scene.pose.y)]
    return points


def row(scenes: Sequence[Scene], text: str) -> str:
    """Return scenes side by side as one SVG, each scaled to its content.

    Args:
        scenes: The scenes.
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
    """A drawing area centred on a rectangle of the floor."""

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
        """Draw grid lines, at whole metres or closer, and label them."""
        wide = WIDTH / self.scale
        step = 0.2 if wide < 2.7 else 0.5 if wide < 3.9 else 1 if wide < 26 else 5
        if wide > 130:
            # A robot outdoors may be thousands of kilometres from where its map begins.
            step = 10.0 ** math.ceil(math.log10(wide / 26))
        for x in _multiples(step, (self.left + self.right) / 2, wide / 2):
            px, _ = self.at((x, 0))
            self._line(px, '0', px, str(HEIGHT), x == 0)
            # Leave out labels that would be cut off on the right.
            if float(px) < WIDTH - EDGE:
                self._label(float(px) + 3, HEIGHT - 4, f'{x:g} m' if x == 0 else f'{x:g}')
        for y in _multiples(step, (self.bottom + self.top) / 2, HEIGHT / self.scale / 2):
            _, py = self.at((0, y))
            self._line('0', py, str(WIDTH), py, y == 0)
            # The bottom corner belongs to the labels of the x axis.
            if float(py) < HEIGHT - 20:
                self._label(3, float(py) - 3, f'{y:g} m' if y == 0 else f'{y:g}')
        self._label(WIDTH - 14, float(self.at((0, 0))[1]) - 3, 'x')
        self._label(float(self.at((0, 0))[0]) - 12, 12, 'y')

    def name(self, frame: str) -> None:
        """Name the frame of the axes."""
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

    def scan(self, scan: Sequence[Point | None], pose: Pose, eye: Point | None = None) -> None:
        """Draw the walls that a robot's scanner sees, and the area before them."""
        seen = [end for end in scan if end is not None]
        if not seen:
            return
        x, y, yaw = pose
        eye = eye or (x + BURGER.scan_x * math.cos(yaw), y + BURGER.scan_x * math.sin(yaw))
        self.fan(scan, eye)
        self.lines(joined(scan, eye), _WALL, 2.5)
        self.dots(seen, _WALL)

    def fan(self, scan: Sequence[Point | None], eye: Point) -> None:
        """Draw the area that the scanner sees."""
        path = 'L'.join(' '.join(self.at(end or eye)) for end in scan)
        self.parts.append(f'<path d="M{path}Z" fill="{_TRAIL}" fill-opacity="0.08"/>')

    def dots(self, points: Sequence[Point], colour: str) -> None:
        # A line of zero length with round caps is a dot.
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

    def robot(self, pose: Pose, colour: str, name: str) -> None:
        """Draw a robot from above: wheels, body, scanner and nose; as in `map.js`."""
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
            f'<circle cx="{x}" cy="{y}" r="{scale * BURGER.radius:.1f}" fill="{colour}" '
            f'fill-opacity="0.18"/><g transform="translate({x} {y}) '
            f'rotate({-math.degrees(pose.yaw):.1f})">'
            f'<path d="{sides}" stroke="{_INK}" stroke-width="{scale * WHEEL_WIDTH:.1f}"/>'
            f'<path d="{body}Z" fill="#ffffff" stroke="{_INK}" stroke-width="2" '
            f'stroke-linejoin="round"/>'
            f'<path d="{path([(0.088, 0), (front, 0.04), (front, -0.04)])}Z" fill="{colour}"/>'
            f'<path d="{path([(BURGER.scan_x, 0)])}h0" stroke="{_INK}" '
            f'stroke-width="{scale * 0.07:.1f}" stroke-linecap="round"/></g>'
        )
        if name:
            above = float(y) - scale * BURGER.radius - 5
            self.parts.append(
                f'<text x="{x}" y="{above:.1f}" fill="{_INK}" text-anchor="middle" '
                f'stroke="#ffffff" stroke-width="3" paint-order="stroke">'
                f'{html.escape(name)}</text>'
            )

    def axes(self, every: Sequence[Axes]) -> None:
        """Draw the axes of frames, each with its letter, and their names below each other."""
        length = max(AXIS, AXIS_PX / self.scale)
        names: list[tuple[float, float]] = []
        for one in every:
            x, y = one.origin
            for letter, (ahead, left) in one.tips.items():
                tip = x + length * ahead, y + length * left
                self.lines([(one.origin, tip)], _AXES[letter], 3)
                beyond = x + 1.2 * length * ahead, y + 1.2 * length * left
                px, py = self.at(beyond)
                self._over(float(px), float(py) + 4, letter, _AXES[letter])
            px, py = self.at(one.origin)
            place = float(px), float(py) + 16
            while any(_are_near(place, other) for other in names):
                place = place[0], place[1] + NAME_PX[1]
            names.append(place)
            self._over(*place, one.name, _INK)

    def _over(self, x: float, y: float, text: str, colour: str) -> None:
        """Write at a point, in px, over what is drawn."""
        self.parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" fill="{colour}" text-anchor="middle" '
            f'stroke="#ffffff" stroke-width="3" paint-order="stroke">{html.escape(text)}</text>'
        )

    def bump(self, point: Point) -> None:
        """Draw a star at the point of contact."""
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


def _are_near(one: Point, other: Point) -> bool:
    """Return whether the names at two points may overlap."""
    return abs(one[0] - other[0]) < NAME_PX[0] and abs(one[1] - other[1]) < NAME_PX[1]


def _multiples(step: float, middle: float, reach: float) -> list[float]:
    """Return the multiples of `step` within `reach` of `middle`."""
    first, last = math.ceil((middle - reach) / step), math.floor((middle + reach) / step)
    return [round(number * step, 6) for number in range(first, last + 1)]


def two(number: float) -> str:
    """Return a number with two decimals, and no minus sign before zero."""
    return f'{round(number, 2) + 0.0:.2f}'


def _direction(angle: float) -> str:
    degrees = round(math.degrees(angle))
    if abs(degrees) <= 5:
        return 'ahead'
    if abs(degrees) >= 175:
        return 'behind'
    return f'{abs(degrees)}° to the {"left" if degrees > 0 else "right"}'
