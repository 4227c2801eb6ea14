"""What the live picture of a graph tells of each of its parts: type, QoS, rate, and what to do."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping

from labkit.background.traffic import Way
from labkit.rosgraph.endpoints import Endpoint
from labkit.rosgraph.snapshot import Graph, GraphTopic
from labkit.views.graph_picture import Line, Picture, Shape

__all__ = ['Flow', 'in_hertz', 'parts', 'way_of']

# A rate is that of the last messages of so many seconds, and of the last two at least.
RATE_SEC = 3.0
# A topic is said to be silent when nothing has come for so long, s, or for three intervals.
SILENT_SEC = 1.5


class Flow:
    """How often messages pass at one place."""

    def __init__(self) -> None:
        # Moments and how many had passed by then.
        self._marks: deque[tuple[float, int]] = deque()

    def add(self, now: float, count: int) -> None:
        """Note that so many have passed just now."""
        total = self._marks[-1][1] if self._marks else 0
        self._marks.append((now, total + count))
        while len(self._marks) > 2 and self._marks[1][0] <= now - RATE_SEC:
            self._marks.popleft()

    def rate(self, now: float) -> float:
        """Return how many pass in a second, Hz."""
        if len(self._marks) < 2:
            return 0.0
        (begin, before), (end, after) = self._marks[0], self._marks[-1]
        rate = (after - before) / (end - begin)
        return rate if now - end <= max(SILENT_SEC, 3 / rate) else 0.0


def in_hertz(rate: float) -> str:
    """Return a rate with its unit; '' for none."""
    if not rate:
        return ''
    return f'{rate:.2g} Hz' if rate < 99.5 else f'{rate:.0f} Hz'


def way_of(line: Line) -> Way | None:
    """Return what passes along an arrow; None for one that is not counted."""
    return (line.kind, line.node, line.other) if line.kind in ('publishes', 'hears') else None


def parts(data: Graph, picture: Picture) -> dict[str, list[str]]:
    """Return what is to be told of each part of a picture, in lines; the first is its name.

    Args:
        data: The graph.
        picture: Its picture.
    """
    topics = {topic.name: topic for topic in data.topics}
    found = {
        f'b{number}': _of_shape(shape, data, topics) for number, shape in enumerate(picture.shapes)
    }
    for number, line in enumerate(picture.lines):
        found[f'a{number}'] = _of_line(line, topics)
    return found


def _of_shape(shape: Shape, data: Graph, topics: Mapping[str, GraphTopic]) -> list[str]:
    if shape.kind == 'topic':
        topic = topics[shape.name]
        return [
            f'Topic {shape.name}',
            *(f'Type: {name}' for name in topic.types),
            *_ends('Published by', topic.publishers),
            *_ends('Subscribed by', topic.subscriptions),
        ]
    if shape.kind == 'node':
        lines = [f'Node {shape.name}', *([] if shape.own else ['In another process'])]
        for words, attribute in (('Publishes', 'publishers'), ('Subscribes to', 'subscriptions')):
            names = [
                topic.name
                for topic in data.topics
                if shape.name in {end.node for end in getattr(topic, attribute)}
            ]
            lines += [f'{words}: {", ".join(names)}'] if names else []
        return lines if len(lines) > 1 else [*lines, 'It neither publishes nor subscribes']
    return [f'{shape.kind.capitalize()} {shape.name}', *(f'Type: {line}' for line in shape.small)]


def _of_line(line: Line, topics: Mapping[str, GraphTopic]) -> list[str]:
    topic = topics.get(line.other) if line.kind in ('publishes', 'hears', 'apart') else None
    if topic is None:
        return [f'{line.node} and the {line.kind} {line.other}']
    if line.kind == 'publishes':
        ends = [end for end in topic.publishers if end.node == line.node]
        return [f'{line.node} publishes on {topic.name}', *_about(ends)]
    ends = [end for end in topic.subscriptions if end.node == line.node]
    if line.kind == 'hears':
        return [f'{line.node} subscribes to {topic.name}', *_about(ends)]
    pairs = [pair for pair in topic.mismatches() if pair.subscription == line.node]
    return [
        f'{line.node} hears nothing of {", ".join(dict.fromkeys(p.publisher for p in pairs))} '
        f'on {topic.name}',
        *dict.fromkeys(pair.reason for pair in pairs),
        *dict.fromkeys(pair.todo for pair in pairs if pair.todo),
    ]


def _ends(words: str, ends: Iterable[Endpoint]) -> list[str]:
    names = dict.fromkeys(end.node for end in ends)
    return [f'{words}: {", ".join(names)}'] if names else []


def _about(ends: Iterable[Endpoint]) -> list[str]:
    """Return type and QoS of the ends of one node, once if they are the same."""
    return list(
        dict.fromkeys(
            f'{end.msg_type}, {_word(end.qos.reliability.name)}, {_word(end.qos.durability.name)}'
            for end in ends
        )
    )


def _word(name: str) -> str:
    return name.lower().replace('_', ' ')
