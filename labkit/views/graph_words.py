"""The text in a graph picture: line breaks, widths, escaping; and the graph in sentences."""

from __future__ import annotations

import re
from html import escape

from labkit.errors import printable
from labkit.rosgraph.matching import why_apart
from labkit.rosgraph.snapshot import Graph, GraphTopic

__all__ = ['description', 'hearing', 'in_lines', 'safe', 'text_width', 'unheard']

# Advance widths of DejaVu Sans, the widest of the usual fonts, in hundredths of the font size.
_WIDTHS = {
    35: " ',.IJijl",
    42: '!()-/:;[\\]frt|',
    56: '"*_`sz',
    63: '?FLPTYacekovxy',
    70: '$0123456789ABCEKRSVXZbdghnpqu{}',
    80: '&DGHNOQUw',
    88: '#+<=>M^~',
    100: '%@Wm',
}
_WIDTH_OF = {char: width for width, chars in _WIDTHS.items() for char in chars}
# Width of bold and regular type, in percent.
_BOLD, _REGULAR = 110, 100


def text_width(text: str, size: int, *, bold: bool = False) -> int:
    """Return the greatest width of a line of text, px.

    Whole numbers: sums of floats differ between Python versions.
    """
    hundredths = sum(_WIDTH_OF.get(char, 100) for char in text) * (_BOLD if bold else _REGULAR)
    return -(-hundredths * size // 10_000)


def in_lines(text: str, limit: int) -> list[str]:
    """Return text broken into lines: at spaces, and long names after `/` or `_`.

    Args:
        text: The text.
        limit: Characters in a line. A longer part of a name stays whole, up to 1.5 times the
            limit.
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
    """Return text escaped for an SVG."""
    # Unprintable characters are not allowed in an SVG at all.
    return escape(printable(text))


def unheard(topic: GraphTopic) -> dict[str, dict[str, list[str]]]:
    """Return who does not hear whom: subscriber -> reason -> publishers."""
    found: dict[str, dict[str, list[str]]] = {}
    for pair in topic.mismatches():
        found.setdefault(pair.subscription, {}).setdefault(pair.reason, []).append(pair.publisher)
    return found


def hearing(topic: GraphTopic) -> list[str]:
    """Return the subscribers that hear a publisher, or would if there were any."""
    return list(
        dict.fromkeys(
            end.node
            for end in topic.subscriptions
            if not topic.publishers or any(not why_apart(o, end) for o in topic.publishers)
        )
    )


def description(data: Graph) -> str:
    """Return the graph in sentences."""
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
