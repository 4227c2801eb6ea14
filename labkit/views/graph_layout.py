"""Where boxes and arrows of a graph are drawn, all in px: what belongs together is one part.

Each part is drawn from left to right or, where that would not fit, from top to bottom; parts stand
beside or under each other. A library was weighed against this: Graphviz needs a program that no
wheel brings, and elk.js and dagre (1.5 MB, 0.3 MB) run in a page only, so that the stored picture
would be another one than the live one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from labkit.views.graph_layers import Link, backward, ranks
from labkit.views.graph_part import Arrow, Box, Drawing, move

__all__ = ['Layout', 'arrange']

# Between two layers: as it should be, and less where it would be too wide, px.
GAPS = (66.0, 54.0, 42.0)
GAP_DOWN = 54.0
# So much of its size is enough to read it.
READABLE = 0.9
# Between parts, px.
BETWEEN_PARTS = 34.0


@dataclass(frozen=True)
class Layout:
    """A drawing: how large it is, px."""

    width: float
    height: float


def arrange(boxes: Sequence[Box], arrows: Sequence[Arrow], width: float) -> Layout:
    """Give all boxes and arrows their places.

    Args:
        boxes: The boxes, those that come first in the order in which they are to stand.
        arrows: The arrows; each leads from a node to another box, or from one to a node.
        width: The drawing should not be wider, px.
    """
    shelves: list[list[_Part]] = [[]]
    for part in _parts(boxes, arrows):
        part.fit(width)
        if shelves[-1] and _wide([*shelves[-1], part]) > width:
            shelves.append([])
        shelves[-1].append(part)
    y = -BETWEEN_PARTS
    for shelf in shelves:
        x, y = 0.0, y + BETWEEN_PARTS
        high = max((part.height for part in shelf), default=0.0)
        for part in shelf:
            part.move(x, y + (high - part.height) / 2)
            x += part.width + BETWEEN_PARTS
        y += high
    return Layout(max(_wide(shelf) for shelf in shelves), y)


def _wide(shelf: Sequence[_Part]) -> float:
    return sum(part.width + BETWEEN_PARTS for part in shelf) - BETWEEN_PARTS


def _parts(boxes: Sequence[Box], arrows: Sequence[Arrow]) -> Iterator[_Part]:
    """Yield what hangs together, those with arrows first."""
    group = {box.name: {box.name} for box in boxes}
    for arrow in arrows:
        one, other = group[arrow.tail], group[arrow.head]
        if one is not other:
            one |= other
            group.update(dict.fromkeys(other, one))
    groups = list({id(members): members for members in group.values()}.values())
    for members in sorted(groups, key=lambda members: len(members) == 1):
        yield _Part(
            [box for box in boxes if box.name in members],
            [arrow for arrow in arrows if arrow.tail in members],
        )


class _Part:
    """Boxes that hang together."""

    def __init__(self, boxes: list[Box], arrows: list[Arrow]) -> None:
        self._boxes = {box.name: box for box in boxes}
        self._arrows = arrows
        links = [(arrow.tail, arrow.head) for arrow in arrows]
        back = backward([box.name for box in boxes], links)
        first = {box.name: int(not box.is_node) for box in boxes}
        self._ranks = ranks(first, [link for link in links if link not in back])
        # One that leads back by a single layer is a line as any other, in the other direction.
        self._back = {link for link in back if self._span(link) < -1}
        self.width = self.height = 0.0

    def _span(self, link: Link) -> int:
        return self._ranks[link[1]] - self._ranks[link[0]]

    def fit(self, width: float) -> None:
        """Choose the direction in which it fits, from left to right if it can be read."""
        for gap in GAPS:
            self._draw(gap, down=False)
            if self.width <= width:
                return
        across = self.width
        if across * READABLE > width:
            self._draw(GAP_DOWN, down=True)
            if self.width > across:
                self._draw(GAPS[-1], down=False)

    def move(self, x: float, y: float) -> None:
        """Move it, from where its corner is at the origin."""
        move(self._boxes.values(), self._arrows, x, y)

    def _draw(self, gap: float, *, down: bool) -> None:
        drawing = Drawing(self._boxes, self._arrows, self._ranks, self._back, gap, down=down)
        self.width, self.height = drawing.draw()
