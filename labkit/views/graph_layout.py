"""The layout of the boxes and arrows of a graph, in px.

graphlay computes it, from left to right or, where that would not fit, from top to bottom. It is
given whole numbers, and its result is rounded to whole numbers before use: stored pictures are
compared character by character, and sums of floats differ between Python versions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import graphlay

__all__ = ['HEADER', 'TO_WORDS', 'Arrow', 'Box', 'Layout', 'arrange']

# Gaps between layers: preferred first, smaller ones where it would be too wide, px.
GAPS = (66, 54, 42)
GAP_DOWN = 54
# Gap between the boxes of a layer, px.
BETWEEN = 18
# Smallest scale at which the picture is still readable.
READABLE = 0.9
# Distance from a line to its label, px.
TO_WORDS = 14
# Room around the boxes of a group, and above them for its name, px.
AROUND, HEADER = 16, 22
# Gaps between an arrow and its boxes, px.
BEGIN, END = 2, 3
CORNER = 12
# Centre boxes among their neighbours; let feedback edges run backwards; give each arrow its own
# port on the side of a box, and each label its own room.
OPTIONS: dict[str, Any] = {
    'coords': {
        'placement': 'brandes_koepf',
        'branch_style': 'symmetric',
        'terminal_centering': True,
    },
    'cycles': {'strategy': 'follow_flow'},
    'routing': {'port_sides': 'facing_only', 'centre_ports': 'off', 'bundle_parallel': False},
    # Otherwise endpoints move after routing, and lines may cross a box.
    'tuning': {'routing': {'step_flatten': 0, 'endpoint_snap': 0, 'port_relax_rounds': 0}},
    'labels': {'reservation': 'always', 'placement': 'gap_centre'},
}

Point = tuple[float, float]


@dataclass(eq=False)
class Box:
    """A box and its place.

    Attributes:
        name: Name that arrows refer to.
        x: Its centre, once arranged; likewise `y`.
        group: The box around it and others, whose size is known once they are arranged.
    """

    name: str
    width: int
    height: int
    x: float = 0.0
    y: float = 0.0
    group: Box | None = None


@dataclass(eq=False)
class Arrow:
    """An arrow and its route.

    Attributes:
        tail: Name of the box where it starts.
        head: Name of the box where it ends.
        words: Width and height of its label, px; None without one.
        steps: Its route from `begin`, once arranged, in SVG commands: `L` with one point, `Q` with
            two.
        mark: The point of the route that the label belongs to.
        upright: Whether it is vertical there: then the label is to the right, else below.
    """

    tail: str
    head: str
    words: tuple[int, int] | None = None
    begin: Point = (0, 0)
    steps: list[tuple[str, list[Point]]] = field(default_factory=list)
    mark: Point = (0, 0)
    upright: bool = False


@dataclass(frozen=True)
class Layout:
    """The size of a drawing, px."""

    width: float
    height: float


def arrange(boxes: Sequence[Box], arrows: Sequence[Arrow], width: float) -> Layout:
    """Place all boxes and arrows.

    Args:
        boxes: The boxes in their preferred order.
        arrows: The arrows; each connects a node with another kind of box.
        width: Width not to exceed if possible, px.
    """
    if not arrows:
        row = _draw(boxes, arrows, GAP_DOWN, down=True)
        if row.width <= width:
            return row
    for gap in GAPS:
        found = _draw(boxes, arrows, gap, down=False)
        if found.width <= width:
            return found
    if found.width * READABLE <= width:
        return found
    down = _draw(boxes, arrows, GAP_DOWN, down=True)
    return down if down.width <= found.width else _draw(boxes, arrows, GAPS[-1], down=False)


def _draw(boxes: Sequence[Box], arrows: Sequence[Arrow], gap: int, *, down: bool) -> Layout:
    """Lay everything out in one direction, with its corner at the origin."""
    wanted = graphlay.Graph()
    groups = list(dict.fromkeys(box.group for box in boxes if box.group is not None))
    for box in boxes:
        inside: dict[str, Any] = {}
        if box.group is not None:
            inside['parent'] = len(boxes) + groups.index(box.group)
        wanted.node(box.name, width=box.width, height=box.height, **inside)
    for group in groups:
        wanted.node(group.name)
    for arrow in arrows:
        wanted.edge(arrow.tail, arrow.head, **_label(arrow, down=down))
    spacing = {'layer_gap': gap, 'node_gap': BETWEEN, 'dummy_gap': BETWEEN}
    spacing |= {'compound_padding': AROUND, 'compound_header': HEADER}
    direction = 'topbottom' if down else 'leftright'
    made = graphlay.layout(wanted, options={**OPTIONS, 'direction': direction, 'spacing': spacing})
    for box, place in zip([*boxes, *groups], made.nodes, strict=True):
        box.x, box.y = _rounded(place['center'])
    for group, place in zip(groups, made.nodes[len(boxes) :], strict=True):
        group.width, group.height = (round(place['size'][side]) for side in ('width', 'height'))
    for arrow, line in zip(arrows, made.edges, strict=True):
        arrow.upright = down
        points = [_rounded(point) for point in line['points']]
        _lead(arrow, points)
        if arrow.words:
            arrow.mark = _nearest(_rounded(line['label_anchor']), points)
    return _to_origin([*boxes, *groups], arrows)


def _label(arrow: Arrow, *, down: bool) -> dict[str, Any]:
    """Return the room for a label: graphlay centres it, so the other side gets as much."""
    if not arrow.words:
        return {}
    width, height = arrow.words
    if down:
        width = 2 * (TO_WORDS + width)
    else:
        height = 2 * (TO_WORDS + height)
    return {'label_size': {'width': width, 'height': height}}


def _rounded(point: dict[str, float]) -> Point:
    return round(point['x']), round(point['y'])


def _nearest(place: Point, points: list[Point]) -> Point:
    """Return the point of a rectilinear route nearest to a place."""
    found = [
        (sorted((one[0], place[0], other[0]))[1], sorted((one[1], place[1], other[1]))[1])
        for one, other in pairwise(points)
    ]
    return min(found, key=lambda point: abs(point[0] - place[0]) + abs(point[1] - place[1]))


def _lead(arrow: Arrow, points: list[Point]) -> None:
    """Route an arrow along straight lines with rounded corners."""
    points = [
        _towards(points[0], points[1], BEGIN),
        *points[1:-1],
        _towards(points[-1], points[-2], END),
    ]
    arrow.begin, arrow.steps = points[0], []
    for before, corner, after in zip(points, points[1:], points[2:], strict=False):
        arrow.steps.append(('L', [_towards(corner, before, CORNER)]))
        arrow.steps.append(('Q', [corner, _towards(corner, after, CORNER)]))
    arrow.steps.append(('L', [points[-1]]))


def _towards(point: Point, other: Point, way: float) -> Point:
    """Return the point at a distance towards another one on a level line, at most halfway."""
    x, y = other[0] - point[0], other[1] - point[1]
    way = min(way, (abs(x) + abs(y)) / 2)
    return point[0] + way * ((x > 0) - (x < 0)), point[1] + way * ((y > 0) - (y < 0))


def _to_origin(boxes: Sequence[Box], arrows: Sequence[Arrow]) -> Layout:
    """Move everything so that its corner is at the origin."""
    points = [point for arrow in arrows for _, ends in arrow.steps for point in ends]
    for box in boxes:
        points += [
            (box.x + side * box.width / 2, box.y + side * box.height / 2) for side in (-1, 1)
        ]
    for arrow in arrows:
        if arrow.words:
            (x, y), (width, height) = arrow.mark, arrow.words
            points += [(x + TO_WORDS + width, y) if arrow.upright else (x, y + TO_WORDS + height)]
    left, top = (min((point[axis] for point in points), default=0) for axis in (0, 1))
    right, bottom = (max((point[axis] for point in points), default=0) for axis in (0, 1))
    for box in boxes:
        box.x, box.y = box.x - left, box.y - top

    def moved(point: Point) -> Point:
        return point[0] - left, point[1] - top

    for arrow in arrows:
        arrow.begin, arrow.mark = moved(arrow.begin), moved(arrow.mark)
        arrow.steps = [(kind, [moved(point) for point in ends]) for kind, ends in arrow.steps]
    return Layout(right - left, bottom - top)
