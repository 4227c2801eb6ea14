"""The tree of frames as a drawing: parents lead to the frames that are given in them.

A frame that moves is round, a static one is a box; each says who publishes it. Where the tree is
cut or has a loop, a dashed arrow with a red cross says so, as between two ends in a graph that do
not match.
"""

from __future__ import annotations

from labkit.views.frames_tree import FrameChain, FrameEdge, FrameTree, Trouble, place_lines
from labkit.views.graph_words import in_lines, text_width
from labkit.views.svg_drawing import (
    SMALL,
    WIDTH,
    Drawing,
    Line,
    Shape,
    labelled,
    shape,
)

__all__ = ['FramesPicture', 'below_name', 'parts']

# Characters in a line of a frame's name, and of a node's.
IN_FRAME, IN_NODE = 18, 22
# What a live picture says of a moving frame fits into its box.
LIVE = text_width('99.9 Hz, 99.9 s old', SMALL)


class FramesPicture(Drawing):
    """A drawing of a tree, or of the way between two frames.

    Args:
        tree: The tree.
        chain: The way, which then is all that is drawn, with numbers.
        why: Why there is no such way.
        width: Width not to exceed if possible, px.

    Attributes:
        edges: The edge that each box stands for, by the box's number; roots have none.
    """

    def __init__(
        self,
        tree: FrameTree,
        chain: FrameChain | None = None,
        why: str = '',
        width: float = WIDTH,
    ) -> None:
        whole = FrameTree(chain.edges) if chain is not None else tree
        self.edges: dict[int, FrameEdge] = {}
        shapes: list[Shape] = []
        wrong = {frame for each in tree.troubles for frame in each.frames}
        for frame in whole.frames:
            edge = next((edge for edge in whole.edges if edge.child == frame), None)
            if edge is not None:
                self.edges[len(shapes)] = edge
            shapes.append(_of_frame(frame, edge, chain, frame in wrong))
        boxes = {one.name: one.box.name for one in shapes}
        lines = [_of_edge(edge, whole, boxes) for edge in whole.edges]
        if chain is None:
            lines += [_apart(each, boxes) for each in tree.troubles if _is_cut(each, tree)]
        caption = [chain.result] if chain is not None else []
        caption += [f'✗ {why}'] if why else []
        troubles = tree.troubles if chain is None else ()
        caption += [line for each in troubles for line in str(each).split('\n')]
        told = '. '.join([*(str(part).rstrip('.') for part in _told(tree, chain, why))])
        super().__init__(
            shapes, lines, title='Tree of frames', told=told, caption=caption, width=width
        )


def parts(picture: FramesPicture, tree: FrameTree) -> dict[str, list[str]]:
    """Return the lines of details for each part of a picture, its name first."""
    found = {}
    for number, one in enumerate(picture.shapes):
        edge = picture.edges.get(number)
        found[f'b{number}'] = [f'Frame {one.name}', *_about(edge), *_wrong(one.name, tree)]
    edges = {(edge.parent, edge.child): edge for edge in tree.edges}
    for number, line in enumerate(picture.lines):
        edge = edges.get((line.node, line.other))
        ends = f'{line.node} and {line.other}' if edge is None else f'{line.other} in {line.node}'
        wrong = _wrong(line.other, tree) if line.kind == 'apart' else []
        found[f'a{number}'] = [ends, *_about(edge), *wrong]
    return found


def _about(edge: FrameEdge | None) -> list[str]:
    if edge is None:
        return []
    topic = '/tf_static' if edge.is_static else '/tf'
    return [f'In {edge.parent}, {edge.kind}', f'Published by {edge.source} on {topic}']


def _wrong(frame: str, tree: FrameTree) -> list[str]:
    return [
        line.strip()
        for one in tree.troubles
        if frame in one.frames
        for line in str(one).split('\n')
    ]


def _told(tree: FrameTree, chain: FrameChain | None, why: str) -> list[str]:
    edges = tree.edges if chain is None else chain.edges
    said = [chain.result] if chain is not None else [why] if why else []
    said += [f'{edge.child} in {edge.parent}, {edge.kind}, from {edge.source}' for edge in edges]
    if chain is None:
        said += [each.text for each in tree.troubles]
    return [f'Frames: {", ".join(tree.frames)}', *said]


def below_name(edge: FrameEdge, chain: FrameChain | None, pace: str = '') -> list[str]:
    """Return the lines below the name of a frame.

    Args:
        edge: The frame in its parent.
        chain: The way that is drawn with numbers, if one is.
        pace: How often it comes and how old it is, for a live picture.
    """
    steps = chain.steps if chain is not None else {}
    numbers = place_lines(steps[edge.child]) if edge.child in steps else []
    return [pace or edge.kind, *in_lines(edge.source, IN_NODE), *numbers]


def _of_frame(frame: str, edge: FrameEdge | None, chain: FrameChain | None, wrong: bool) -> Shape:
    if edge is None:
        return shape('root', frame, ['root'], wrong=wrong, in_name=IN_FRAME)
    small = below_name(edge, chain)
    least = 0 if edge.is_static else LIVE
    return shape(edge.kind, frame, small, wrong=wrong, in_name=IN_FRAME, least=least)


def _of_edge(edge: FrameEdge, tree: FrameTree, boxes: dict[str, str]) -> Line:
    ends = edge.parent, edge.child
    between = boxes[edge.parent], boxes[edge.child]
    several = sum(other.child == edge.child for other in tree.edges) > 1
    loop = [each.label for each in tree.troubles if each.label and each.frames == ends]
    if several:
        return labelled(
            'apart',
            ends,
            between,
            ['two parents:', *in_lines(f'from {edge.source}', IN_NODE)],
        )
    return labelled('apart' if loop else 'holds', ends, between, loop)


def _is_cut(trouble: Trouble, tree: FrameTree) -> bool:
    edges = {(edge.parent, edge.child) for edge in tree.edges}
    return bool(trouble.label) and trouble.frames not in edges


def _apart(trouble: Trouble, boxes: dict[str, str]) -> Line:
    first, second = trouble.frames
    return labelled('apart', (first, second), (boxes[first], boxes[second]), [trouble.label])
