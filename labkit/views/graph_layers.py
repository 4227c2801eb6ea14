"""Boxes in layers: which stands before which, in which order, and where, so that lines run clear.

The steps are those of Sugiyama, Tagawa and Toda (1981, IEEE Transactions on Systems, Man, and
Cybernetics 11). What closes a loop is set aside; the longest path from a beginning is the layer of
a box; in a layer, boxes stand in the order of what they are connected with; the places are those
nearest to the neighbours that leave room for all (an isotonic regression).

Nothing here knows of ROS, nor of pictures. A layer has a place along the way of the messages
(`along`), and its boxes have theirs across it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

__all__ = ['Vertex', 'backward', 'crossings', 'order', 'place', 'ranks']

# So many times the layers are gone through: the order and the places are steady long before.
SWEEPS = 24
# Room between the boxes of a layer, and beside a line that passes through it, px.
BETWEEN = 18.0
BESIDE_LINE = 10.0

Link = tuple[str, str]


@dataclass(eq=False)
class Vertex:
    """What takes room in a layer: a box, the words at a line, or a line that passes through.

    Attributes:
        name: The name of a box, '' for what belongs to a line.
        layer: Number of the layer.
        length: Size along the way of the messages, px.
        before: Size across, on one side of its middle, px.
        after: Size across, on the other side, px.
        across: Where its middle is, px.
        near: What it is connected with in other layers.
    """

    name: str
    layer: int
    length: float = 0.0
    before: float = 0.0
    after: float = 0.0
    across: float = 0.0
    near: list[Vertex] = field(default_factory=list)

    @property
    def passes(self) -> bool:
        """Tell whether it is no more than a line on its way."""
        return not self.name


def backward(names: Sequence[str], links: Iterable[Link]) -> set[Link]:
    """Return the links that close a loop, as seen from those that nothing leads to.

    Args:
        names: The boxes. The first ones are begun with where everything is in a loop.
        links: Pairs of names.
    """
    heads: dict[str, list[str]] = {name: [] for name in names}
    led_to = set()
    for tail, head in dict.fromkeys(links):
        heads[tail].append(head)
        led_to.add(head)
    found: set[Link] = set()
    done: set[str] = set()
    for start in sorted(names, key=lambda name: name in led_to):
        # A walk in depth. Whoever is on the way to here is in `way`.
        way, steps = {start: None}, [iter(heads[start])]
        if start in done:
            continue
        done.add(start)
        while steps:
            here = list(way)[-1]
            for head in steps[-1]:
                if head in way:
                    found.add((here, head))
                elif head not in done:
                    done.add(head)
                    way[head] = None
                    steps.append(iter(heads[head]))
                    break
            else:
                way.popitem()
                steps.pop()
    return found


def ranks(first: Mapping[str, int], links: Iterable[Link]) -> dict[str, int]:
    """Return the number of each box on the longest path that leads to it.

    Args:
        first: Box -> its number if nothing leads to it.
        links: Pairs of names, without loops.
    """
    links = list(dict.fromkeys(links))
    found = dict(first)
    for _ in found:
        later = {head for tail, head in links if found[head] <= found[tail]}
        if not later:
            break
        found.update(
            {head: max(found[tail] + 1 for tail, h in links if h == head) for head in later}
        )
    heads = {head for _, head in links}
    for name in found:
        # What nothing leads to stands beside what it leads to, not at the far end.
        led = [found[head] for tail, head in links if tail == name]
        if led and name not in heads:
            found[name] = min(led) - 1
    least = min(found.values(), default=0)
    return {name: rank - least for name, rank in found.items()}


def order(layers: list[list[Vertex]]) -> None:
    """Sort each layer, so that few lines cross."""
    best, fewest = [list(layer) for layer in layers], crossings(layers)
    for sweep in range(SWEEPS):
        if not fewest:
            break
        forward = sweep % 2 == 0
        pairs = list(pairwise(layers))
        for left, right in pairs if forward else reversed(pairs):
            fixed, free = (left, right) if forward else (right, left)
            where = {vertex: number for number, vertex in enumerate(fixed)}
            middles = {v: _middle(v, where, number) for number, v in enumerate(free)}
            free.sort(key=middles.__getitem__)
        count = crossings(layers)
        if count < fewest:
            best, fewest = [list(layer) for layer in layers], count
    layers[:] = best


def _middle(vertex: Vertex, where: Mapping[Vertex, float], otherwise: float) -> float:
    near = [where[other] for other in vertex.near if other in where]
    return sum(near) / len(near) if near else otherwise


def crossings(layers: Sequence[Sequence[Vertex]]) -> int:
    """Return how many pairs of lines between neighbouring layers cross."""
    count = 0
    for left, right in pairwise(layers):
        where = {vertex: number for number, vertex in enumerate(right)}
        ends = [(i, where[v]) for i, one in enumerate(left) for v in one.near if v in where]
        count += sum(
            (a[0] - b[0]) * (a[1] - b[1]) < 0
            for number, a in enumerate(ends)
            for b in ends[number + 1 :]
        )
    return count


def place(layers: Sequence[Sequence[Vertex]]) -> None:
    """Give each vertex its place across: near to its neighbours, and in the order of its layer."""
    for layer in layers:
        total = 0.0
        for above, vertex in zip([None, *layer], layer, strict=False):
            total += _room(above, vertex) if above else 0.0
            vertex.across = total
        for vertex in layer:
            vertex.across -= total / 2
    for sweep in range(SWEEPS):
        # Back and forth, looking at one side only: so a chain is straight to its end.
        side = 1 if sweep % 2 == 0 else -1
        for layer in reversed(layers) if side == 1 else layers:
            _settle(layer, side)


def _room(above: Vertex, below: Vertex) -> float:
    between = BESIDE_LINE if above.passes or below.passes else BETWEEN
    return above.after + between + below.before


def _settle(layer: Sequence[Vertex], side: int) -> None:
    """Move the vertices of a layer towards their neighbours, as far as they leave room.

    The sum of squared ways is the least where each block of those that touch stands at the mean
    of what its members wish (pool adjacent violators).

    Args:
        layer: The layer.
        side: 1 for the neighbours that come later, -1 for those before.
    """
    # Each block: mean wish, its weight, its vertices with their way from the first one.
    blocks: list[tuple[float, float, list[tuple[Vertex, float]]]] = []
    offset = 0.0
    for above, vertex in zip([None, *layer], layer, strict=False):
        offset += _room(above, vertex) if above else 0.0
        near = [v.across for v in vertex.near if (v.layer - vertex.layer) * side > 0]
        wish = sum(near) / len(near) if near else vertex.across
        # A line on its way is to be straight.
        weight = 4.0 if vertex.passes else 1.0
        block = (wish - offset, weight, [(vertex, offset)])
        while blocks and blocks[-1][0] > block[0]:
            mean, other, members = blocks.pop()
            total = other + block[1]
            middle = (mean * other + block[0] * block[1]) / total
            block = (middle, total, members + block[2])
        blocks.append(block)
    for mean, _, members in blocks:
        for vertex, way in members:
            vertex.across = mean + way
