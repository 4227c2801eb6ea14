"""The tree of frames as data: who publishes which edge, and what is wrong with it, in words."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from labkit.errors import printable
from labkit.transforms.rotations import matrix, to_rpy
from labkit.transforms.tree import Place

__all__ = ['FrameChain', 'FrameEdge', 'FrameTree', 'Trouble', 'grown', 'place_lines']

# Turned by less than this, rad, a frame is not turned about an axis.
STRAIGHT = math.radians(0.05)
_NUMBERS = {2: 'two', 3: 'three'}
# tf2's words for a loop begin so; the tree follows.
_LOOP = 'The tf tree is invalid because it contains a loop.'

# From the outside to the inside, as REP 105 names them.
_ORDER = ('earth', 'map', 'odom', 'base_footprint', 'base_link')


@dataclass(frozen=True, order=True)
class FrameEdge:
    """A frame in its parent, as somebody publishes it.

    Attributes:
        parent: The parent.
        child: The frame.
        is_static: Whether it comes on /tf_static, and holds at any time.
        authors: Full names of the nodes that publish it, or may: a message does not say who.
        is_certain: Whether each of these does.
    """

    parent: str
    child: str
    is_static: bool = False
    authors: tuple[str, ...] = ()
    is_certain: bool = True

    @property
    def kind(self) -> str:
        """Return how it moves."""
        return 'static' if self.is_static else 'moving'

    @property
    def source(self) -> str:
        """Return who publishes it, in words."""
        return (' and ' if self.is_certain else ' or ').join(self.authors) or 'an unknown node'


@dataclass(frozen=True)
class Trouble:
    """What is wrong with a tree.

    Attributes:
        frames: The frames that it is about.
        text: What is wrong, where tf2 says it in its words.
        todo: What to do.
        label: A few words for the drawing, beside the arrow from the first frame to the second.
    """

    frames: tuple[str, ...]
    text: str
    todo: str = ''
    label: str = ''

    def __str__(self) -> str:
        return f'✗ {self.text}' + (f'\n  → {self.todo}' if self.todo else '')


@dataclass(frozen=True)
class FrameTree:
    """All frames, sorted by name. `str(tree)` is the tree in words.

    Attributes:
        edges: Each frame in its parent; one with two parents is there twice.
        troubles: What is wrong.
    """

    edges: tuple[FrameEdge, ...] = ()
    troubles: tuple[Trouble, ...] = ()

    @property
    def roots(self) -> tuple[str, ...]:
        """The frames without a parent, and one of each loop; that of the most frames first."""
        return tuple(_roots(self.edges))

    @property
    def frames(self) -> tuple[str, ...]:
        """All frames: parents before their children."""
        return tuple(
            dict.fromkeys(frame for root in self.roots for frame in _below(root, self.edges))
        )

    def __str__(self) -> str:
        lines = _lines(self.roots, self.edges, lambda edge: '')
        return '\n'.join([*lines, *map(str, self.troubles)])


@dataclass(frozen=True)
class FrameChain:
    """The way between two frames, with numbers at its latest time.

    Attributes:
        target: The frame in which places are given.
        source: The frame whose place is asked for.
        place: Where that is, and how it is turned.
        edges: The edges on the way, sorted by name.
        steps: The place of each frame on the way in its parent.
    """

    target: str
    source: str
    place: Place
    edges: tuple[FrameEdge, ...]
    steps: dict[str, Place]

    @property
    def result(self) -> str:
        """Return where the source is in the target, in words."""
        return f'{self.source} in {self.target}: {", ".join(place_lines(self.place))}'

    def __str__(self) -> str:
        def more(edge: FrameEdge) -> str:
            return f': {", ".join(place_lines(self.steps[edge.child]))}'

        if not self.edges:
            return self.result
        return '\n'.join([self.result, *_lines(_roots(self.edges), self.edges, more)])


def place_lines(place: Place) -> list[str]:
    """Return a place in lines: x, y and z in m, then how it is turned, in degrees."""
    shift, turn = place
    angles = to_rpy(matrix(turn))
    named = dict(zip(('roll', 'pitch', 'yaw'), angles, strict=True))
    if all(abs(named[name]) < STRAIGHT for name in ('roll', 'pitch')):
        named = {'yaw': named['yaw']}
    return [
        *(f'{axis} = {_rounded(way, 3)} m' for axis, way in zip('xyz', shift, strict=True)),
        *(f'{name} = {_rounded(math.degrees(angle), 1)}°' for name, angle in named.items()),
    ]


def _rounded(number: float, digits: int) -> str:
    """Return a number with its digits, and no minus sign before zero."""
    return f'{round(number, digits) + 0.0:.{digits}f}'


def grown(
    edges: Iterable[FrameEdge], why_apart: Callable[[str, str], str], refused: Iterable[str] = ()
) -> FrameTree:
    """Return the tree that edges make, with what is wrong with it.

    Args:
        edges: Frames in their parents.
        why_apart: Returns what tf2 says of the way between two frames, '' if there is one.
        refused: What tf2 has said of transforms that it has not taken.
    """
    found = tuple(sorted(edges))
    troubles = [*_two_parents(found), *_said_twice(found), *_loops(found, why_apart)]
    troubles += _cuts(found, why_apart)
    troubles += [Trouble((), printable(words)) for words in refused]
    return FrameTree(found, tuple(troubles))


def _cuts(edges: Sequence[FrameEdge], why_apart: Callable[[str, str], str]) -> Iterator[Trouble]:
    """Yield that trees are not connected, but for loops, and those that share a frame."""
    children = {edge.child for edge in edges}
    first, *others = [root for root in _roots(edges) if root not in children] or ['']
    held = set(_below(first, edges))
    for other in others:
        words = why_apart(first, other)
        if words and held.isdisjoint(_below(other, edges)):
            yield Trouble(
                (first, other),
                printable(words),
                'Publish a transform that connects the two trees, such as one with frame_id '
                '{!r} and child_frame_id {!r}.'.format(*_in_order(first, other)),
                'not connected',
            )


def _in_order(*roots: str) -> list[str]:
    """Return frames, those first that hold the others by REP 105."""
    return sorted(roots, key=lambda name: _ORDER.index(name) if name in _ORDER else len(_ORDER))


def _parents(edges: Sequence[FrameEdge]) -> dict[str, list[FrameEdge]]:
    found: dict[str, list[FrameEdge]] = {}
    for edge in edges:
        found.setdefault(edge.child, []).append(edge)
    return found


def _two_parents(edges: Sequence[FrameEdge]) -> Iterator[Trouble]:
    for child, above in _parents(edges).items():
        if len(above) > 1:
            names = ' and '.join(f'{edge.parent} (from {edge.source})' for edge in above)
            number = _NUMBERS.get(len(above), len(above))
            so = (
                'is all that counts'
                if all(edge.is_static for edge in above)
                else 'counts, so the tree changes all the time'
            )
            yield Trouble(
                (child,),
                f'{child} has {number} parents: {names}. A frame has one: the last that tf2 has '
                f'heard {so}.',
                f'Let only one node publish where {child} is.',
            )


def _said_twice(edges: Sequence[FrameEdge]) -> Iterator[Trouble]:
    for edge in edges:
        if len(edge.authors) > 1 and edge.is_certain:
            yield Trouble(
                (edge.child,),
                f'{edge.source} both publish where {edge.child} is in {edge.parent}: '
                + (
                    'the last one that is heard holds.'
                    if edge.is_static
                    else 'it jumps between what they say.'
                ),
                'Let only one of them publish it.',
            )


def _loops(edges: Sequence[FrameEdge], why_apart: Callable[[str, str], str]) -> Iterator[Trouble]:
    for edge in edges:
        if _closes_loop(edge, edges) and edge.child in _roots(edges):
            words = why_apart(edge.child, edge.parent).partition('\n')[0]
            yield Trouble(
                (edge.parent, edge.child),
                words if words.startswith(_LOOP) else _LOOP,
                f'Take one of its transforms away, such as that of {edge.child} in {edge.parent}.',
                'a loop',
            )


def _closes_loop(edge: FrameEdge, edges: Sequence[FrameEdge]) -> bool:
    return edge.parent in _below(edge.child, edges)


def _roots(edges: Sequence[FrameEdge]) -> list[str]:
    """Return the frames without a parent, and one of each loop; that of the most frames first."""
    children = {edge.child for edge in edges}
    names = sorted({edge.parent for edge in edges} | children)
    roots = [name for name in names if name not in children]
    reached = {frame for root in roots for frame in _below(root, edges)}
    for name in names:
        # What no root leads to goes round in a circle.
        if name not in reached and name in _below_children(name, edges):
            roots.append(name)
            reached.update(_below(name, edges))
    return sorted(roots, key=lambda root: (-len(_below(root, edges)), root))


def _below_children(frame: str, edges: Sequence[FrameEdge]) -> set[str]:
    return {found for edge in edges if edge.parent == frame for found in _below(edge.child, edges)}


def _below(frame: str, edges: Sequence[FrameEdge]) -> list[str]:
    """Return a frame and all that it holds, parents first."""
    children: dict[str, list[str]] = {}
    for edge in edges:
        children.setdefault(edge.parent, []).append(edge.child)
    found: dict[str, None] = {}
    waiting = [frame]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found[name] = None
            waiting += reversed(children.get(name, []))
    return list(found)


def _lines(
    roots: Sequence[str], edges: Sequence[FrameEdge], more: Callable[[FrameEdge], str]
) -> Iterator[str]:
    """Yield the lines of trees; a frame that is met again is not followed again."""
    met = set(roots)

    def below(frame: str, indent: str) -> Iterator[str]:
        inside = [edge for edge in edges if edge.parent == frame]
        for edge in inside:
            last = edge is inside[-1]
            again = ' (see above)' if edge.child in met else ''
            yield (
                f'{indent}{"└─" if last else "├─"} {edge.child}{again}: {edge.kind}, '
                f'from {edge.source}{more(edge)}'
            )
            if not again:
                met.add(edge.child)
                yield from below(edge.child, indent + ('   ' if last else '│  '))

    for root in roots:
        yield root
        yield from below(root, '')
