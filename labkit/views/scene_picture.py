"""A scene as SVG without a browser: what is near is drawn over what is far.

The picture is the same for equal scenes: there is no time in it, and places are rounded. It has
its own background, because an image can't know whether the page is dark.
"""

from __future__ import annotations

import html
import math
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from labkit.errors import printable
from labkit.transforms.rotations import matrix
from labkit.transforms.tree import Place
from labkit.views.scene_shapes import faces_of
from labkit.views.scene_things import HERE, Thing, composed, corners_of, moved

__all__ = ['Camera', 'camera_for', 'to_svg']

WIDTH, HEIGHT, MARGIN = 640, 400, 20
# The camera looks from behind and from the right on a robot that looks along x, and down, rad. Its
# field of view from top to bottom, rad; what is nearer than this is not seen, m.
AZIMUTH, ELEVATION = math.radians(-125), math.radians(38)
FIELD, NEAR = math.radians(40), 0.02
# Of a thing as far away as it is large, px.
SCALE = HEIGHT / 2 / math.tan(FIELD / 2)
# All is seen from no nearer than this, m, with so much room around it. What is farther away than
# this does not count, m.
LEAST_DISTANCE, ROOM, MOST = 0.6, 1.02, 50.0
# A frame in the middle is so many times as near.
FOLLOWED = 3.0
# Lines of the grid are 1 m apart, and there are so many cells to each side, as in RViz.
CELLS = 5
AXIS, AXIS_WIDTH, LEAST_PX = 0.08, 0.004, 0.7
_MARKS = ('points', 'line', 'lines')
# A mesh of more triangles than this is drawn as the box around it.
MOST_FACES = 3000
# So many faces are in a picture, those of the largest things; what is smaller then is a dot. So
# many points and pieces of lines are, too: of more, some are left out. A notebook stores it.
MOST_SOLID, MOST_MARKS = 12_000, 4_000
# Where light comes from, and how bright a face is that turns away from it.
LIGHT, SHADE = np.array((0.34, -0.5, 0.8)), 0.38
# The colours of the page's light theme; see `scene.css`.
COLOURS = {
    'ink': '#424242',
    'grid': '#e0e0e0',
    'thing': '#9e9e9e',
    'wall': '#b0bec5',
    'post': '#90a4ae',
    'laser': '#c62828',
    'path': '#2e7d32',
    'goal': '#8e24aa',
    'odometry': '#ef6c00',
    'x': '#c62828',
    'y': '#2e7d32',
    'z': '#1565c0',
}


class Camera(NamedTuple):
    """From where a scene is looked at.

    Attributes:
        target: The place in the middle, m.
        distance: How far away that is, m.
    """

    target: tuple[float, float, float]
    distance: float

    def seen(self, points: Any) -> Any:
        """Return how far right, up and away points are, m: rows, for rows of places."""
        ahead, right, up = _directions()
        relative = np.asarray(points, dtype=np.float64) - np.array(self.target)
        across = relative @ np.array((right, up, ahead)).T
        return across + np.array((0.0, 0.0, self.distance))

    def on_paper(self, seen: Any) -> Any:
        """Return where they are in the picture, px from its corner; see `seen`."""
        away = np.maximum(seen[..., 2], NEAR)
        x = WIDTH / 2 + SCALE * seen[..., 0] / away
        y = HEIGHT / 2 - SCALE * seen[..., 1] / away
        return np.stack([x, y], axis=-1)


def camera_for(things: Iterable[Thing], places: Mapping[str, Place], follow: str = '') -> Camera:
    """Return a camera that sees all.

    Args:
        things: What there is.
        places: Where frames are in the fixed frame.
        follow: A frame that has to be in the middle; '' for none.
    """
    rows = [np.array([place[0] for place in places.values()]).reshape(-1, 3)]
    for thing in things:
        at = HERE if not thing.frame else places.get(thing.frame)
        if at is not None and len(corners := corners_of(thing)):
            rows.append(moved(at, corners))
    points = np.concatenate(rows)
    points = points[(np.abs(points) <= MOST).all(axis=1)]
    if not len(points):
        points = np.zeros((1, 3))
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    ahead, right, up = _directions()
    off, slope = points - middle, math.tan(FIELD / 2)
    far = np.maximum(np.abs(off @ right) * HEIGHT / WIDTH, np.abs(off @ up)) / slope
    distance = max(LEAST_DISTANCE, float((ROOM * far - off @ ahead).max()))
    if follow in places:
        return Camera(places[follow][0], distance / FOLLOWED)
    x, y, z = middle.tolist()
    return Camera((x, y, z), distance)


def to_svg(
    things: Iterable[Thing],
    places: Mapping[str, Place],
    text: str,
    *,
    follow: str = '',
    axes: bool = True,
    grid: bool = True,
) -> str:
    """Return a scene as an SVG picture.

    Args:
        things: What there is.
        places: Where frames are in the fixed frame; their axes are drawn.
        text: Text alternative.
        follow: A frame in the middle; '' to see all.
        axes: Whether frames are drawn.
        grid: Whether the floor is drawn.
    """
    things = list(things)
    paper = _Paper(camera_for(things, places, follow), things)
    if grid:
        paper.grid()
    for thing in things:
        at = HERE if not thing.frame else places.get(thing.frame)
        if at is not None:
            paper.thing(thing, composed(at, thing.place))
    paper.finish()
    if axes:
        paper.axes(places)
    words = html.escape('\n'.join(map(printable, text.splitlines())))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
        f'width="{WIDTH}" height="{HEIGHT}" role="img" font-family="sans-serif" font-size="12">'
        f'<title>{words}</title><rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>\n'
        + '\n'.join(paper.parts)
        + '\n</svg>'
    )


class _Paper:
    """A picture in the making: what is drawn waits until all is known that is farther away."""

    def __init__(self, camera: Camera, things: Iterable[Thing]) -> None:
        self.camera = camera
        marks = [each for each in things if each.shape in _MARKS]
        self._most_marks = MOST_MARKS // max(1, len(marks))
        self._dots = _small_ones(each for each in things if each.shape not in (*_MARKS, 'text'))
        self.parts: list[str] = []
        # How far away, the kind of what is drawn, and that.
        self._waiting: list[tuple[float, str, str]] = []

    def grid(self) -> None:
        """Draw the floor."""
        reach = float(CELLS)
        ways = [(float(i), -reach, float(i), reach) for i in range(-CELLS, CELLS + 1)]
        ways += [(b, a, d, c) for a, b, c, d in ways]
        lines = [((a, b, 0.0), (c, d, 0.0)) for a, b, c, d in ways]
        self.parts.append(f'<path d="{self._lines(lines)}" fill="none" stroke="{_hex("grid")}"/>')

    def axes(self, places: Mapping[str, Place]) -> None:
        """Draw the axes of frames, and the names of those that have room."""
        taken: list[tuple[float, float]] = []
        for place in places.values():
            origin, columns = place[0], zip(*matrix(place[1]), strict=True)
            away = max(NEAR, float(self.camera.seen([origin])[0, 2]))
            width = max(LEAST_PX, AXIS_WIDTH * SCALE / away)
            for letter, column in zip('xyz', columns, strict=True):
                tip = tuple(a + AXIS * b for a, b in zip(origin, column, strict=True))
                way = self._lines([(origin, tip)])
                self.parts.append(
                    f'<path d="{way}" stroke="{_hex(letter)}" stroke-width="{width:.1f}"/>'
                )
        for name, place in places.items():
            seen = self.camera.seen([place[0]])
            x, y = self.camera.on_paper(seen)[0]
            near = any(abs(x - a) < 90 and abs(y - b) < 13 for a, b in taken)
            if seen[0, 2] > NEAR and not near and 0 < x < WIDTH and 0 < y < HEIGHT:
                taken.append((x, y))
                self.parts.append(_text(name, x, y + 14))

    def thing(self, thing: Thing, place: Place) -> None:
        """Draw a thing that is at a place in the fixed frame."""
        if thing.shape == 'text':
            seen = self.camera.seen([place[0]])
            x, y = self.camera.on_paper(seen)[0]
            self._add(seen[0, 2], 'text', _text(thing.text, x, y))
        elif id(thing) in self._dots:
            self._dot(thing, place)
        elif thing.shape in _MARKS:
            self._marks(thing, moved(place, np.asarray(thing.points, float) * thing.size))
        else:
            self._faces(thing, place)

    def finish(self) -> None:
        """Draw what waits, the farthest first; equal marks one after the other are one path."""
        last = ''
        for _, look, drawn in sorted(self._waiting, key=lambda each: -each[0]):
            if look.startswith('<') and look == last:
                self.parts[-1] = self.parts[-1].removesuffix('"/>') + drawn + '"/>'
            else:
                self.parts.append(f'{look}{drawn}"/>' if look.startswith('<') else drawn)
            last = look

    def _marks(self, thing: Thing, points: Any) -> None:
        """Draw points, or lines through them."""
        colour = _colour(thing)
        step = max(1, math.ceil(len(points) / max(1, self._most_marks)))
        if thing.shape != 'lines':
            points = points[::step]
        if thing.shape != 'points':
            by_two = points[: len(points) // 2 * 2].reshape(-1, 2, 3)[::step]
            through = np.stack([points[:-1], points[1:]], axis=1)
            ends = by_two if thing.shape == 'lines' else through
            ends = ends[np.isfinite(ends).all(axis=(1, 2))]
            width = 2.0 if thing.metres else thing.width
            look = f'<path stroke="{colour}" stroke-width="{width:g}" d="'
            for end in ends:
                away = float(self.camera.seen(end)[:, 2].mean())
                self._add(away, look, self._lines([end]))
            return
        seen = self.camera.seen(points[np.isfinite(points).all(axis=1)])
        seen = seen[seen[:, 2] > NEAR]
        width = 3.0 if thing.metres else thing.width
        look = f'<path stroke="{colour}" stroke-width="{width:g}" stroke-linecap="round" d="'
        for away, (x, y) in zip(seen[:, 2], self.camera.on_paper(seen), strict=True):
            self._add(away, look, f'M{x:.1f} {y:.1f}h0')

    def _dot(self, thing: Thing, place: Place) -> None:
        seen = self.camera.seen([place[0]])
        away = float(seen[0, 2])
        if away > NEAR:
            (x, y), width = self.camera.on_paper(seen)[0], SCALE * _extent(thing) / away
            pale = f' opacity="{thing.alpha:g}"' if thing.alpha < 1 else ''
            look = f'<path stroke="{_colour(thing)}" stroke-width="{max(1.0, width):.0f}" '
            look += f'stroke-linecap="round"{pale} d="'
            self._add(away, look, f'M{x:.1f} {y:.1f}h0')

    def _faces(self, thing: Thing, place: Place) -> None:
        closed, groups = faces_of(thing, MOST_FACES)
        colour = _colour(thing)
        pale = f' opacity="{thing.alpha:g}"' if thing.alpha < 1 else ''
        for faces in groups:
            corners = moved(place, faces)
            normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            lengths = np.linalg.norm(normals, axis=1)
            normals /= np.where(lengths > 0, lengths, 1)[:, None]
            backs = ((corners[:, 0] - _eye(self.camera)) * normals).sum(axis=1) > 0
            seen = self.camera.seen(corners)
            drawn = (lengths > 0) & (seen[:, :, 2].min(axis=1) > NEAR) & ~(backs & closed)
            normals[backs] *= -1
            bright = 1 - SHADE + SHADE * (normals @ LIGHT)
            away, paper = seen[:, :, 2].mean(axis=1), self.camera.on_paper(seen)
            for i in np.flatnonzero(drawn):
                paint = _shaded(colour, bright[i])
                way = 'L'.join(f'{x:.1f} {y:.1f}' for x, y in paper[i])
                look = f'fill="{paint}" stroke="{paint}" stroke-width="0.5"{pale}'
                self._add(away[i], '', f'<path {look} d="M{way}z"/>')

    def _add(self, away: float, look: str, drawn: str) -> None:
        self._waiting.append((away, look, drawn))

    def _lines(self, lines: Iterable[Any]) -> str:
        """Return the way of lines, as far as they are in front of the camera."""
        way = ''
        for ends in lines:
            begin, end = self.camera.seen(ends)
            if begin[2] < NEAR and end[2] < NEAR:
                continue
            if begin[2] < NEAR:
                begin = _cut(begin, end)
            elif end[2] < NEAR:
                end = _cut(end, begin)
            (a, b), (c, d) = self.camera.on_paper(np.array([begin, end]))
            way += f'M{a:.1f} {b:.1f}L{c:.1f} {d:.1f}'
        return way


def _small_ones(solids: Iterable[Thing]) -> set[int]:
    """Return the `id` of each solid for whose faces there is no room in a picture."""
    sorted_ones = sorted(solids, key=_extent, reverse=True)
    left = MOST_SOLID
    for number, thing in enumerate(sorted_ones):
        left -= sum(map(len, faces_of(thing, MOST_FACES)[1]))
        if left < 0:
            return set(map(id, sorted_ones[number:]))
    return set()


def _extent(thing: Thing) -> float:
    """Return how large a solid is, m."""
    if thing.points is None or not len(thing.points):
        return max(map(abs, thing.size))
    return float((np.ptp(thing.points, axis=0) * np.abs(thing.size)).max())


def _directions() -> tuple[Any, Any, Any]:
    """Return where ahead, right and up are for the camera."""
    level = math.cos(ELEVATION)
    away = (level * math.cos(AZIMUTH), level * math.sin(AZIMUTH), math.sin(ELEVATION))
    ahead = -np.array(away)
    right = np.array((-math.sin(AZIMUTH), math.cos(AZIMUTH), 0.0))
    return ahead, right, np.cross(right, ahead)


def _eye(camera: Camera) -> Any:
    return np.array(camera.target) - camera.distance * _directions()[0]


def _cut(behind: Any, before: Any) -> Any:
    """Return the point of a line that is as near as can be seen."""
    share = (NEAR - behind[2]) / (before[2] - behind[2])
    return behind + share * (before - behind)


def _hex(name: str) -> str:
    return COLOURS.get(name, name)


def _colour(thing: Thing) -> str:
    return _hex(thing.colour)


def _shaded(colour: str, bright: float) -> str:
    parts = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return '#' + ''.join(f'{min(255, round(bright * part)):02x}' for part in parts)


def _text(words: str, x: float, y: float) -> str:
    words = html.escape(printable(words))
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="middle" fill="{_hex("ink")}" '
        f'stroke="#ffffff" stroke-width="3" paint-order="stroke">{words}</text>'
    )
