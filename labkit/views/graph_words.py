"""The words in the picture of a graph: broken into lines, measured, and safe in an SVG."""

from __future__ import annotations

import re
from html import escape

from labkit.rosgraph.matching import why_apart
from labkit.rosgraph.snapshot import Graph, GraphTopic

__all__ = ['description', 'hearing', 'in_lines', 'safe', 'text_width', 'unheard']

# Advance widths of DejaVu Sans, in parts of the font's size: of the usual fonts the widest.
_WIDTHS = {
    0.35: " ',.IJijl",
    0.42: '!()-/:;[\\]frt|',
    0.56: '"*_`sz',
    0.63: '?FLPTYacekovxy',
    0.70: '$0123456789ABCEKRSVXZbdghnpqu{}',
    0.80: '&DGHNOQUw',
    0.88: '#+<=>M^~',
    1.0: '%@Wm',
}
_WIDTH_OF = {char: width for width, chars in _WIDTHS.items() for char in chars}
_BOLD = 1.1


def text_width(text: str, size: float, *, bold: bool = False) -> float:
    """Return how wide a line of text is at most, px.

    Args:
        text: The line.
        size: Size of the font, px.
        bold: Whether it is bold.
    """
    return sum(_WIDTH_OF.get(char, 1.0) for char in text) * size * (_BOLD if bold else 1.0)


def in_lines(text: str, limit: int) -> list[str]:
    """Return text in lines: broken at spaces, and a long name after `/` or `_`.

    Args:
        text: The text.
        limit: Letters in a line. A part of a name that is longer stays whole, up to half as much
            again.
    """
    most = limit + limit // 2
    pieces = []
    for word in text.split():
        parts = [word] if len(word) <= limit else re.findall(r'[^/_]*[/_]|[^/_]+', word)
        pieces += [
            (' ' * (number == at == 0), part[at : at + most])
            for number, part in enumerate(parts)
            for at in range(0, len(part), most)
        ]
    lines: list[str] = []
    for space, piece in pieces:
        if lines and len(lines[-1] + space + piece) <= limit:
            lines[-1] += space + piece
        else:
            lines.append(piece)
    return lines


def safe(text: str) -> str:
    """Return text that means nothing but itself in an SVG."""
    # What has no form may not be in an SVG at all.
    return escape(''.join(char if char.isprintable() else '\ufffd' for char in text))


def unheard(topic: GraphTopic) -> dict[str, dict[str, list[str]]]:
    """Return who does not hear whom: subscribing node -> reason -> publishing nodes."""
    found: dict[str, dict[str, list[str]]] = {}
    for pair in topic.mismatches():
        found.setdefault(pair.subscription, {}).setdefault(pair.reason, []).append(pair.publisher)
    return found


def hearing(topic: GraphTopic) -> list[str]:
    """Return the subscribing nodes that hear somebody, or would if somebody published."""
    return list(
        dict.fromkeys(
            end.node
            for end in topic.subscriptions
            if not topic.publishers or any(not why_apart(o, end) for o in topic.publishers)
        )
    )


def description(data: Graph) -> str:
    """Return the graph in sentences, with arrows: what a picture of it shows.

    Args:
        data: The graph.
    """
    said = []
    for topic in data.topics:
        publishers = list(dict.fromkeys(end.node for end in topic.publishers))
        said.append(_chain(publishers, topic.name, topic.types, hearing(topic)))
        said += [
            f'{who} does not hear {", ".join(whom)} on {topic.name}: {reason}'
            for who, reasons in unheard(topic).items()
            for reason, whom in reasons.items()
        ]
    for service in data.services:
        said.append(
            'Service: ' + _chain(service.clients, service.name, service.types, service.servers)
        )
    for action in data.actions:
        said.append('Action: ' + _chain(action.clients, action.name, action.types, action.servers))
    foreign = [node.name for node in data.nodes if not node.own]
    if foreign:
        said.append(f'In another process: {", ".join(foreign)}')
    return '. '.join([f'Nodes: {", ".join(node.name for node in data.nodes)}', *said]) + '.'


def _chain(
    tails: list[str] | tuple[str, ...],
    name: str,
    types: tuple[str, ...],
    heads: list[str] | tuple[str, ...],
) -> str:
    parts = [', '.join(tails), f'{name} [{", ".join(types)}]', ', '.join(heads)]
    return ' → '.join(part for part in parts if part)
