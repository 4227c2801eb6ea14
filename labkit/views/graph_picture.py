"""The computation graph as a drawing.

Nodes are round, topics are boxes, services are hexagons, and actions have double sides.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from labkit.rosgraph.snapshot import Graph, GraphNode
from labkit.views.graph_layout import Box
from labkit.views.graph_words import description, hearing, in_lines, unheard
from labkit.views.svg_drawing import (
    IN_REASON,
    IN_TYPE,
    WIDTH,
    Drawing,
    Line,
    Shape,
    box_name,
    labelled,
    shape,
)

__all__ = ['Picture']

KINDS = ('node', 'topic', 'service', 'action')
# At most this many unheard publishers are named.
NAMED = 2


class Picture(Drawing):
    """A drawing of a graph.

    Args:
        width: Width not to exceed if possible, px.
        wrong: Full names of the nodes and topics that a fault is told about.
    """

    def __init__(self, data: Graph, width: float = WIDTH, wrong: Collection[str] = ()) -> None:
        shapes = [_of_node(node, node.name in wrong) for node in data.nodes]
        for kind, found in (
            ('topic', data.topics),
            ('service', data.services),
            ('action', data.actions),
        ):
            shapes += [_of_kind(kind, each.name, each.types, each.name in wrong) for each in found]
        frames = _frames(data)
        for one in shapes:
            one.box.group = _frame_of(one.name, frames)
        super().__init__(
            shapes,
            list(_lines(data)),
            frames=frames,
            title='Computation graph',
            told=description(data),
            width=width,
        )


def _of_node(node: GraphNode, wrong: bool) -> Shape:
    small = [] if node.own else ['another process']
    if node.count > 1:
        is_folded = node.name.endswith('/*')
        small += [f'{node.count} nodes' if is_folded else f'{node.count} nodes of this name']
    return shape('node', node.name, small, own=node.own, wrong=wrong)


def _of_kind(kind: str, name: str, types: Sequence[str], wrong: bool) -> Shape:
    under = [line for each in types for line in in_lines(each, IN_TYPE)]
    return shape(kind, name, under, wrong=wrong)


def _frames(data: Graph) -> dict[str, Box]:
    """Return a box for each namespace that has nodes, but for the root."""
    spaces = {node.name.rpartition('/')[0] for node in data.nodes}
    return {space: Box(box_name('namespace', space), 0, 0) for space in sorted(spaces - {''})}


def _frame_of(name: str, frames: dict[str, Box]) -> Box | None:
    """Return the box of the innermost namespace of a name."""
    inside = [space for space in frames if name.startswith(f'{space}/')]
    return frames[max(inside, key=len)] if inside else None


def _lines(data: Graph) -> list[Line]:
    nodes = {node.name for node in data.nodes}
    found = []
    for topic in data.topics:
        publishing = dict.fromkeys(end.node for end in topic.publishers)
        found += [_line('publishes', node, topic.name) for node in publishing]
        found += [_line('hears', node, topic.name) for node in hearing(topic)]
        for node, reasons in unheard(topic).items():
            for reason, whom in reasons.items():
                found.append(_line('apart', node, topic.name, _why(whom, reason)))
    for kind, ends in (('service', data.services), ('action', data.actions)):
        for each in ends:
            found += [_line(kind, node, each.name) for node in each.clients]
            found += [_line(kind, node, each.name, serves=True) for node in each.servers]
    return [line for line in found if line.node in nodes]


def _line(
    kind: str, node: str, other: str, words: list[str] | None = None, *, serves: bool = False
) -> Line:
    where = kind if kind in KINDS else 'topic'
    tail, head = box_name('node', node), box_name(where, other)
    if kind in ('hears', 'apart') or serves:
        tail, head = head, tail
    return labelled(kind, (node, other), (tail, head), words or [])


def _why(whom: list[str], reason: str) -> list[str]:
    more = len(whom) - NAMED
    others = f' and {more} more' if more > 0 else ''
    first = f'does not hear {", ".join(whom[:NAMED])}{others}:'
    return [*in_lines(first, IN_REASON), *in_lines(reason, IN_REASON)]
