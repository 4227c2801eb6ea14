"""One part of a graph, drawn from left to right or from top to bottom: boxes, arrows, words.

A layer of boxes has its place along the way of the messages, and each box its own across it. An
arrow that closes a loop leads around all of it, as in the pictures of control engineering.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise

from labkit.views.graph_layers import Link, Vertex, order, place

__all__ = ['Arrow', 'Box', 'Drawing', 'move']

# Beside the words at a line, px.
GAP_AT_WORDS = 26.0
# Steep lines need a longer way: so much of their height.
STEEP = 0.16
MAX_GAP = 150.0
# Between the ends of lines at one side of a box, px.
BETWEEN_ENDS = 16.0
# From a line to the words beside it, px.
TO_WORDS = 14.0
# An arrow begins and ends so far from its boxes, px.
BEGIN, END = 2.0, 3.0
# Of lines that lead back: how far they stay away from boxes and from each other, px.
BACK = 22.0
BETWEEN_BACK = 18.0
# How near to the next layer they turn, px.
TURN = 10.0
CORNER = 12.0
# A bend that is as small as that is not drawn, px.
NEARLY = 8.0

Point = tuple[float, float]


@dataclass(eq=False)
class Box:
    """A box, and where it is drawn.

    Attributes:
        name: What arrows call it.
        width: Its size, px.
        height: Its size, px.
        is_node: Nodes stand in every other layer, and what connects them in between.
        x: Its middle, once it is arranged.
        y: Its middle, once it is arranged.
    """

    name: str
    width: float
    height: float
    is_node: bool
    x: float = 0.0
    y: float = 0.0


@dataclass(eq=False)
class Arrow:
    """An arrow, and where it is drawn.

    Attributes:
        tail: Name of the box that it leaves.
        head: Name of the box that it leads to.
        words: Width and height of the words beside it, px; None if there are none.
        steps: Its way, once it is arranged: the begin, then pieces as SVG names them, `L` with one
            point, `Q` with two and `C` with three.
        mark: The point on its way that its words belong to.
        upright: Whether it goes up or down there: then its words are at its right, else under it.
    """

    tail: str
    head: str
    words: tuple[float, float] | None = None
    begin: Point = (0.0, 0.0)
    steps: list[tuple[str, list[Point]]] = field(default_factory=list)
    mark: Point = (0.0, 0.0)
    upright: bool = False


class Drawing:
    """One part in one direction.

    It is drawn as if from left to right. From top to bottom, both directions are exchanged.
    """

    def __init__(
        self,
        boxes: dict[str, Box],
        arrows: list[Arrow],
        rank: dict[str, int],
        back: set[Link],
        gap: float,
        *,
        down: bool,
    ) -> None:
        self._boxes, self._arrows, self._least, self._down = boxes, arrows, gap, down
        self._is_back = {arrow: (arrow.tail, arrow.head) in back for arrow in arrows}
        self._vertices = {name: self._vertex(box, 2 * rank[name]) for name, box in boxes.items()}
        # Layers of boxes have even numbers; where words stand between them, there is one more.
        self._layers: dict[int, list[Vertex]] = {}
        for vertex in self._vertices.values():
            self._layers.setdefault(vertex.layer, []).append(vertex)
        for arrow in arrows:
            if arrow.words and not self._is_back[arrow]:
                self._layers.setdefault(self._vertices[arrow.head].layer - self._way(arrow), [])
        self._chains = {arrow: self._chain(arrow) for arrow in arrows if not self._is_back[arrow]}
        # Where each layer begins and ends along the way.
        self._spans: dict[int, tuple[float, float]] = {}
        # Arrow and end -> where it meets the box, across.
        self._ports: dict[tuple[Arrow, str], float] = {}

    def draw(self) -> tuple[float, float]:
        """Give all of it its place, with the corner at the origin; return width and height."""
        numbers = sorted(self._layers)
        layers = [self._layers[number] for number in numbers]
        order(layers)
        self._layers = dict(zip(numbers, layers, strict=True))
        place(layers)
        self._lay_layers()
        self._find_ports()
        for arrow, chain in self._chains.items():
            self._lead(arrow, chain)
        self._lead_back()
        for name, vertex in self._vertices.items():
            begin, end = self._spans[vertex.layer]
            box = self._boxes[name]
            box.x, box.y = self._point((begin + end) / 2, vertex.across)
        return self._to_origin()

    def _point(self, along: float, across: float) -> Point:
        return (across, along) if self._down else (along, across)

    def _vertex(self, box: Box, layer: int) -> Vertex:
        length, breadth = box.width, box.height
        if self._down:
            length, breadth = breadth, length
        return Vertex(box.name, layer, length, breadth / 2, breadth / 2)

    def _way(self, arrow: Arrow) -> int:
        """Return 1 for an arrow that leads on, -1 for one that leads back."""
        return 1 if self._vertices[arrow.head].layer > self._vertices[arrow.tail].layer else -1

    def _words(self, arrow: Arrow) -> tuple[float, float]:
        """Return the size of an arrow's words, along and across."""
        assert arrow.words is not None
        width, height = arrow.words
        return (height, width) if self._down else (width, height)

    def _chain(self, arrow: Arrow) -> list[Vertex]:
        """Return what an arrow meets, from the lower layer to the higher one."""
        ends = sorted(
            (self._vertices[arrow.tail], self._vertices[arrow.head]), key=lambda end: end.layer
        )
        at_words = self._vertices[arrow.head].layer - self._way(arrow) if arrow.words else None
        chain = [ends[0]]
        for layer in sorted(self._layers):
            if ends[0].layer < layer < ends[1].layer:
                vertex = Vertex('', layer)
                if layer == at_words:
                    length, across = self._words(arrow)
                    vertex = Vertex(f'words {arrow.head}', layer, length, 12, TO_WORDS + across)
                self._layers[layer].append(vertex)
                chain.append(vertex)
        chain.append(ends[1])
        for one, other in pairwise(chain):
            one.near.append(other)
            other.near.append(one)
        return chain

    def _lay_layers(self) -> None:
        """Give each layer its place along the way."""
        along, before = 0.0, None
        for number in sorted(self._layers):
            layer = self._layers[number]
            if before is not None:
                along += self._gap(before, number)
            length = max((vertex.length for vertex in layer), default=0.0)
            self._spans[number] = (along, along + length)
            along, before = along + length, number

    def _gap(self, before: int, number: int) -> float:
        rise = max(
            (
                abs(vertex.across - other.across)
                for vertex in self._layers[number]
                for other in vertex.near
                if other.layer == before
            ),
            default=0.0,
        )
        least = GAP_AT_WORDS if (before + number) % 2 else self._least
        return max(least, min(STEEP * rise, MAX_GAP))

    def _find_ports(self) -> None:
        """Give each end of an arrow its place at the side of its box."""
        sides: dict[tuple[str, bool], list[tuple[float, int, Arrow, str]]] = {}
        for number, arrow in enumerate(self._arrows):
            for end, name in (('tail', arrow.tail), ('head', arrow.head)):
                if self._is_back[arrow]:
                    # It leaves behind and comes in front, below the others.
                    side, other = end == 'tail', float('inf')
                else:
                    chain = self._chains[arrow]
                    side = chain[0].name == name
                    other = (chain[1] if side else chain[-2]).across
                sides.setdefault((name, side), []).append((other, number, arrow, end))
        for (name, _), ends in sides.items():
            vertex = self._vertices[name]
            room = max(0.0, 2 * vertex.before - 20)
            step = min(BETWEEN_ENDS, room / max(1, len(ends) - 1))
            first = vertex.across - step * (len(ends) - 1) / 2
            for index, (_, _, arrow, end) in enumerate(sorted(ends, key=lambda each: each[:2])):
                self._ports[arrow, end] = first + index * step
        for ends in sides.values():
            if len(ends) == 1:
                # Alone at its side: a straight line is better than one that meets the middle.
                _, _, arrow, end = ends[0]
                other = self._ports[arrow, 'head' if end == 'tail' else 'tail']
                straight = len(self._chains.get(arrow, ())) == 2
                if straight and abs(self._ports[arrow, end] - other) <= NEARLY:
                    self._ports[arrow, end] = other

    def _side(self, name: str, *, higher: bool, away: float) -> float:
        """Return where a box ends along the way, and so much further away."""
        vertex = self._vertices[name]
        begin, end = self._spans[vertex.layer]
        middle, half = (begin + end) / 2, vertex.length / 2
        return middle + half + away if higher else middle - half - away

    def _lead(self, arrow: Arrow, chain: list[Vertex]) -> None:
        """Lead an arrow through what it meets."""
        way = self._way(arrow)
        on = way == 1
        begin = (self._side(arrow.tail, higher=on, away=BEGIN), self._ports[arrow, 'tail'])
        end = (self._side(arrow.head, higher=not on, away=END), self._ports[arrow, 'head'])
        # Straight as far as its layer goes: beside a narrow box there may be a wide one.
        leave = self._spans[self._vertices[arrow.tail].layer][on] + way * BEGIN
        reach = self._spans[self._vertices[arrow.head].layer][not on] - way * END
        points = [begin, (leave, begin[1])]
        for vertex in chain[1:-1] if on else chain[-2:0:-1]:
            span, across = self._spans[vertex.layer], vertex.across
            if abs(across - points[-1][1]) <= NEARLY:
                across = points[-1][1]
            points += [(along, across) for along in (span if on else span[::-1])]
            if vertex.name:
                arrow.mark = self._point(sum(span) / 2, across)
                arrow.upright = self._down
        points += [(reach, end[1]), end]
        arrow.begin = self._point(*begin)
        arrow.steps = []
        for one, other in pairwise(dict.fromkeys(points)):
            if abs(one[1] - other[1]) < 0.5:
                arrow.steps.append(('L', [self._point(*other)]))
            else:
                half = (one[0] + other[0]) / 2
                bend = [(half, one[1]), (half, other[1]), other]
                arrow.steps.append(('C', [self._point(*point) for point in bend]))

    def _lead_back(self) -> None:
        """Lead the arrows that close a loop around the boxes between their ends."""
        back = [arrow for arrow in self._arrows if self._is_back[arrow]]
        level = max(v.across + v.after for layer in self._layers.values() for v in layer)
        level += BACK
        for number, arrow in enumerate(sorted(back, key=self._length)):
            out = self._beside(self._vertices[arrow.tail].layer, 1, number / len(back))
            into = self._beside(self._vertices[arrow.head].layer, -1, number / len(back))
            self._bend(
                arrow,
                [
                    (self._side(arrow.tail, higher=True, away=BEGIN), self._ports[arrow, 'tail']),
                    (out, self._ports[arrow, 'tail']),
                    (out, level),
                    (into, level),
                    (into, self._ports[arrow, 'head']),
                    (self._side(arrow.head, higher=False, away=END), self._ports[arrow, 'head']),
                ],
            )
            arrow.mark, arrow.upright = self._point((out + into) / 2, level), self._down
            level += BETWEEN_BACK
            if arrow.words:
                level += TO_WORDS + self._words(arrow)[1]

    def _beside(self, layer: int, side: int, part: float) -> float:
        """Return where a line turns between two layers, so that several have room."""
        gap = GAP_AT_WORDS if layer + side in self._layers else self._least
        least = min(BACK, gap / 2 - 2)
        return self._spans[layer][side == 1] + side * (least + (gap - TURN - least) * part)

    def _length(self, arrow: Arrow) -> int:
        return self._vertices[arrow.tail].layer - self._vertices[arrow.head].layer

    def _bend(self, arrow: Arrow, points: list[Point]) -> None:
        """Lead an arrow along straight lines with round corners."""
        arrow.begin, arrow.steps = self._point(*points[0]), []
        for before, corner, after in zip(points, points[1:], points[2:], strict=False):
            arrow.steps.append(('L', [self._point(*_towards(corner, before))]))
            bend = [corner, _towards(corner, after)]
            arrow.steps.append(('Q', [self._point(*point) for point in bend]))
        arrow.steps.append(('L', [self._point(*points[-1])]))

    def _to_origin(self) -> tuple[float, float]:
        """Move all of it, so that its corner is at the origin; return width and height."""
        points = [point for arrow in self._arrows for _, ends in arrow.steps for point in ends]
        for box in self._boxes.values():
            points += [(box.x - box.width / 2, box.y - box.height / 2)]
            points += [(box.x + box.width / 2, box.y + box.height / 2)]
        for arrow in self._arrows:
            if arrow.words:
                (x, y), (width, height) = arrow.mark, arrow.words
                points += [
                    (x + TO_WORDS + width, y) if arrow.upright else (x, y + TO_WORDS + height)
                ]
        left, top = (min(point[axis] for point in points) for axis in (0, 1))
        right, bottom = (max(point[axis] for point in points) for axis in (0, 1))
        move(self._boxes.values(), self._arrows, -left, -top)
        return right - left, bottom - top


def move(boxes: Iterable[Box], arrows: Iterable[Arrow], x: float, y: float) -> None:
    """Move boxes and arrows, px."""
    for box in boxes:
        box.x, box.y = box.x + x, box.y + y
    for arrow in arrows:
        arrow.begin = (arrow.begin[0] + x, arrow.begin[1] + y)
        arrow.mark = (arrow.mark[0] + x, arrow.mark[1] + y)
        arrow.steps = [
            (kind, [(px + x, py + y) for px, py in points]) for kind, points in arrow.steps
        ]


def _towards(corner: Point, other: Point) -> Point:
    """Return the point where a round corner begins or ends."""
    way = (other[0] - corner[0], other[1] - corner[1])
    length = abs(way[0]) + abs(way[1])
    part = min(CORNER, length / 2) / length if length else 0.0
    return corner[0] + way[0] * part, corner[1] + way[1] * part
