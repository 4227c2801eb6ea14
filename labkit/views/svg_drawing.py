"""Boxes and arrows as an SVG, in the shapes and colours of the course's pictures.

The same drawing is stored with a lesson, printed, and live in JupyterLab: of the computation graph
(`labkit.views.graph_picture`), and of the tree of frames (`labkit.views.frames_picture`). Boxes
of different kinds differ in shape or words, so nothing depends on colour. It has its own
background, because an image can't know whether the page is dark.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from labkit.views.graph_layout import HEADER, TO_WORDS, Arrow, Box, arrange
from labkit.views.graph_words import in_lines, safe, text_width

__all__ = [
    'IN_REASON',
    'IN_TYPE',
    'MARGIN',
    'SMALL',
    'WIDTH',
    'Drawing',
    'Line',
    'Shape',
    'box_name',
    'caption_lines',
    'fitting',
    'labelled',
    'shape',
]

# Width that fits a notebook page at full size; and how narrow a picture may become, px.
WIDTH, NARROWEST = 900.0, 340.0
MARGIN = 24.0
# Font sizes and line height, px.
NAME, SMALL, ROW = 15, 13, 18
# Characters in a line.
IN_NAME, IN_TYPE, IN_REASON = 28, 36, 30
# Least height of a box, and padding around its text, px.
HEIGHT, PADDING = 48, 32
# Height of a box per arrow, and its maximum, px.
FOR_ARROW, HIGHEST = 14, 132
# Mean width of a small letter, px.
LETTER = 6.5
# Half the size of a cross, px.
CROSS = 11

INK, LINE, WRONG = '#1f2933', '#52606d', '#c62828'
# A sign at a box that something is told about: fill, border, size in px.
SIGN, SIGN_EDGE, SIGN_SIZE = '#ffc53d', '#7a4d00', 22
# kind -> (fill, border)
COLOURS = {
    'node': ('#e3f0fb', '#1f6fb2'),
    'topic': ('#fdf3d7', '#a8730a'),
    'service': ('#e3f6e8', '#1b7f3b'),
    'action': ('#f1eafa', '#6b3fa0'),
    # Frames: at the top of a tree, in motion, and fixed to their parents.
    'root': ('#e3f6e8', '#1b7f3b'),
    'moving': ('#e3f0fb', '#1f6fb2'),
    'static': ('#fdf3d7', '#a8730a'),
}
ROUND = ('node', 'moving')
# Of the frame around a namespace; it is transparent.
FRAME = '#9aa5b1'


@dataclass(frozen=True, eq=False)
class Shape:
    """A box of the drawing.

    Attributes:
        kind: `'node'`, `'topic'`, `'service'` or `'action'`; of a frame `'root'`, `'moving'` or
            `'static'`.
        name: What it stands for.
        names: Its name, broken into lines.
        small: Lines below the name.
        own: Whether a node belongs to this process.
        box: Its place.
        wrong: Whether a fault is told about it, so that it has a sign.
    """

    kind: str
    name: str
    names: list[str]
    small: list[str]
    own: bool
    box: Box
    wrong: bool = False


@dataclass(frozen=True, eq=False)
class Line:
    """An arrow of the drawing.

    Attributes:
        kind: `'publishes'`, `'hears'`, `'apart'`, `'service'` or `'action'`; of frames
            `'holds'`, or `'apart'`.
        node: The node at one of its ends; of frames, the parent.
        other: The topic, service or action at the other end; of frames, the other one.
        words: Lines of its label.
        arrow: Its route.
    """

    kind: str
    node: str
    other: str
    words: list[str]
    arrow: Arrow


class Drawing:
    """Boxes and arrows, arranged.

    Args:
        shapes: The boxes, in their preferred order.
        lines: The arrows.
        frames: A box around others for each of some names; its size is known once it is arranged.
        title: What it is.
        told: The same in sentences.
        caption: Text above it; a part that begins with ✗ is red.
        width: Width not to exceed if possible, px.

    Attributes:
        shapes: Its boxes.
        lines: Its arrows.
        told: See above.
        width: Its size, px; likewise `height`.
    """

    def __init__(
        self,
        shapes: Sequence[Shape],
        lines: Sequence[Line],
        *,
        title: str,
        told: str,
        frames: Mapping[str, Box] | None = None,
        caption: Sequence[str] = (),
        width: float = WIDTH,
    ) -> None:
        self.shapes, self.lines = list(shapes), list(lines)
        self._title, self.told = title, told
        self._caption = caption_lines(caption, width)
        self._frames = frames or {}
        for one in self.shapes:
            ends = [
                sum(getattr(line.arrow, end) == one.box.name for line in self.lines)
                for end in ('tail', 'head')
            ]
            one.box.height = max(one.box.height, min(12 + FOR_ARROW * max(ends), HIGHEST))
        layout = arrange(
            [one.box for one in self.shapes],
            [line.arrow for line in self.lines],
            width - 2 * MARGIN,
        )
        self._above = ROW * len(self._caption) + (MARGIN / 2 if caption else 0)
        widest = max([layout.width, *(text_width(line, SMALL) for line, _ in self._caption)])
        self.width = widest + 2 * MARGIN
        self.height = layout.height + 2 * MARGIN + self._above

    def svg(self) -> str:
        """Return the drawing as SVG, without scripts, the same for equal ones."""
        named = [(f'a{number}', line) for number, line in enumerate(self.lines)]
        parts = [
            *(_frame_svg(space, box) for space, box in self._frames.items()),
            # Those with labels last: no line may cross a label.
            *(_line_svg(*each) for each in sorted(named, key=lambda each: bool(each[1].words))),
            *(_shape_svg(f'b{number}', one) for number, one in enumerate(self.shapes)),
        ]
        drawn = '\n'.join(parts)
        told = safe(self.told)
        # Several pictures on one page must not share ids.
        name = f'graph-{zlib.crc32((drawn + told).encode()):08x}'
        width, height = round(self.width), round(self.height)
        return f"""\
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" \
height="{height}" role="img" aria-labelledby="{name}-title {name}-desc" font-family="sans-serif" \
font-size="{NAME}" fill="{INK}" style="max-width: 100%; height: auto">
<title id="{name}-title">{self._title}</title>
<desc id="{name}-desc">{told}</desc>
<defs><marker id="{name}-tip" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="14" \
markerHeight="14" markerUnits="userSpaceOnUse" orient="auto"><path class="tip" \
d="M0 0 L10 5 L0 10 z" fill="{LINE}"/></marker></defs>
<rect class="ground" x="0.5" y="0.5" width="{width - 1}" height="{height - 1}" rx="10" \
fill="#ffffff" stroke="#9aa5b1"/>{_caption_svg(self._caption)}
<g transform="translate({MARGIN:g} {MARGIN + self._above:g})">
{drawn.replace('url(#tip)', f'url(#{name}-tip)')}
</g>
</svg>"""


def fitting(page_width: float) -> float:
    """Return the width of a picture in a page that is so wide, px; for NaN, the narrowest."""
    # In this order: whatever is compared to NaN is not less.
    return min(max(NARROWEST, float(page_width)), WIDTH)


def caption_lines(caption: Sequence[str], width: float) -> list[tuple[str, bool]]:
    """Return the lines of a caption, and whether each is red; see `Drawing`."""
    room = max(IN_REASON, int((width - 2 * MARGIN) / LETTER))
    return [(line, part.startswith('✗')) for part in caption for line in in_lines(part, room)]


def shape(
    kind: str,
    name: str,
    small: Sequence[str] = (),
    *,
    own: bool = True,
    wrong: bool = False,
    in_name: int = IN_NAME,
    least: int = 0,
) -> Shape:
    """Return a box as large as its text.

    Args:
        kind: What it stands for.
        name: Its name.
        small: Lines below that.
        own: Whether a node belongs to this process.
        wrong: Whether it has a warning sign.
        in_name: Characters in a line of the name.
        least: Its least width, px.
    """
    names = in_lines(name, in_name)
    wide = max(
        *(text_width(line, NAME, bold=True) for line in names),
        *(text_width(line, SMALL) for line in small or ['']),
        least,
    )
    high = ROW * (len(names) + len(small)) + 18
    box = Box(box_name(kind, name), wide + PADDING, max(HEIGHT, high))
    return Shape(kind, name, names, list(small), own, box, wrong)


def box_name(kind: str, name: str) -> str:
    """Return a unique name: a node and a topic may have the same one."""
    return f'{kind} {name}'


def labelled(kind: str, ends: tuple[str, str], boxes: tuple[str, str], words: list[str]) -> Line:
    """Return an arrow with a label.

    Args:
        kind: What it stands for.
        ends: See `Line.node` and `Line.other`.
        boxes: Names of the boxes where it begins and ends.
        words: Lines of its label.
    """
    size = None
    if words:
        size = (max(text_width(line, SMALL) for line in words), ROW * len(words))
    return Line(kind, *ends, words, Arrow(*boxes, size))


# -- as SVG -------------------------------------------------------------------------------------


def _caption_svg(lines: Sequence[tuple[str, bool]]) -> str:
    drawn = ''
    for number, (line, wrong) in enumerate(lines):
        look = f'class="caption wrong" fill="{WRONG}"' if wrong else 'class="caption"'
        drawn += (
            f'\n<text {look} x="{MARGIN:g}" y="{MARGIN + ROW * number + 10:g}" '
            f'font-size="{SMALL}">{safe(line)}</text>'
        )
    return drawn


def _shape_svg(name: str, shape: Shape) -> str:
    box = shape.box
    fill, edge = COLOURS[shape.kind]
    x, y, width, height = box.x - box.width / 2, box.y - box.height / 2, box.width, box.height
    look = f'class="body" fill="{fill}" stroke="{edge}" stroke-width="2"'
    if not shape.own:
        look += ' stroke-dasharray="6 4"'
    place = f'x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}"'
    if shape.kind in ROUND:
        body = f'<rect {place} rx="24" {look}/>'
    elif shape.kind == 'service':
        left, right = x + 14, x + width - 14
        body = (
            f'<path d="M{left:.1f} {y:.1f} H{right:.1f} L{x + width:.1f} {box.y:.1f} '
            f'L{right:.1f} {y + height:.1f} H{left:.1f} L{x:.1f} {box.y:.1f} z" {look}/>'
        )
    else:
        body = f'<rect {place} rx="4" {look}/>'
    if shape.kind == 'action':
        for side in (x + 7, x + width - 7):
            body += (
                f'<path class="side" d="M{side:.1f} {y:.1f} V{y + height:.1f}" stroke="{edge}" '
                'stroke-width="2"/>'
            )
    # The middle of a line of text is a third of the font size above its baseline.
    down = box.y + 5 - ROW * (len(shape.names) + len(shape.small) - 1) / 2
    text = ''
    for number, line in enumerate([*shape.names, *shape.small]):
        bold = number < len(shape.names)
        style = 'font-weight="bold"' if bold else f'class="small" font-size="{SMALL}"'
        text += (
            f'<text x="{box.x:.1f}" y="{down + number * ROW:.1f}" text-anchor="middle" {style}>'
            f'{safe(line)}</text>'
        )
    sign = _sign_svg(x + width - 10, y) if shape.wrong else ''
    return f'<g class="{shape.kind}" data-part="{name}">{body}{text}{sign}</g>'


def _sign_svg(x: float, y: float) -> str:
    """Return a warning sign with its middle at a point."""
    half = SIGN_SIZE / 2
    return (
        f'<path class="sign" d="M{x:.1f} {y - half:.1f} l{half:g} {SIGN_SIZE - 2:g} '
        f'h-{SIGN_SIZE:g} z" fill="{SIGN}" stroke="{SIGN_EDGE}" stroke-width="1.5" '
        'stroke-linejoin="round"/>'
        f'<text x="{x:.1f}" y="{y + half - 4:.1f}" text-anchor="middle" font-weight="bold" '
        f'font-size="{SMALL}" fill="{SIGN_EDGE}">!</text>'
    )


def _frame_svg(space: str, box: Box) -> str:
    left, top = box.x - box.width / 2, box.y - box.height / 2
    return (
        f'<g class="namespace"><rect x="{left:.1f}" y="{top:.1f}" width="{box.width:.1f}" '
        f'height="{box.height:.1f}" rx="12" fill="{FRAME}" fill-opacity="0.12" '
        f'stroke="{FRAME}"/><text class="small" x="{left + 14:.1f}" y="{top + HEADER - 4:.1f}" '
        f'font-size="{SMALL}">{safe(space)}</text></g>'
    )


def _line_svg(name: str, line: Line) -> str:
    arrow = line.arrow
    way = f'M{_at(arrow.begin)}' + ''.join(
        f' {kind}{" ".join(_at(point) for point in points)}' for kind, points in arrow.steps
    )
    width = 4 if line.kind == 'action' else 2
    dashes = ' stroke-dasharray="5 4"' if line.kind == 'apart' else ''
    drawn = (
        f'<path class="way" d="{way}" fill="none" stroke="{LINE}" stroke-width="{width}"{dashes} '
        'marker-end="url(#tip)"/>'
    )
    if line.words:
        drawn += _cross_svg(line)
    return f'<g class="arrow {line.kind}" data-part="{name}">{drawn}</g>'


def _cross_svg(line: Line) -> str:
    (x, y), upright = line.arrow.mark, line.arrow.upright
    a, b, c, d = x - CROSS, x + CROSS, y - CROSS, y + CROSS
    drawn = (
        f'<path class="cross" d="M{a:.1f} {c:.1f} L{b:.1f} {d:.1f} M{b:.1f} {c:.1f} '
        f'L{a:.1f} {d:.1f}" stroke="{WRONG}" stroke-width="3" fill="none"/>'
    )
    if upright:
        left, first, anchor = x + TO_WORDS, y + 5 - ROW * (len(line.words) - 1) / 2, 'start'
    else:
        left, first, anchor = x, y + TO_WORDS + 13, 'middle'
    for number, words in enumerate(line.words):
        drawn += (
            f'<text class="small beside" x="{left:.1f}" y="{first + number * ROW:.1f}" '
            f'text-anchor="{anchor}" font-size="{SMALL}" stroke="#ffffff" stroke-width="4" '
            f'paint-order="stroke">{safe(words)}</text>'
        )
    return drawn


def _at(point: tuple[float, float]) -> str:
    return f'{point[0]:.1f} {point[1]:.1f}'
