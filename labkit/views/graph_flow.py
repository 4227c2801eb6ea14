"""The details of each part of a live graph picture: type, QoS, rate, and what to do."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping

from labkit.asking.traffic import Way
from labkit.rosgraph.endpoints import Endpoint
from labkit.rosgraph.snapshot import Graph, GraphTopic
from labkit.silent.watch import seen_about
from labkit.views.svg_drawing import Drawing, Line, Shape

__all__ = ['Flow', 'in_hertz', 'parts', 'way_of']

# A rate covers the messages of this many seconds, and at least the last two.
RATE_SEC = 3.0
# A topic without messages for this long, s, or for three intervals, counts as silent.
SILENT_SEC = 1.5


class Flow:
    """The rate of messages along one arrow."""

    def __init__(self) -> None:
        # Pairs of a time and the total at that time.
        self._marks: deque[tuple[float, int]] = deque()

    def add(self, now: float, count: int) -> None:
        """Count messages that have just passed."""
        total = self._marks[-1][1] if self._marks else 0
        self._marks.append((now, total + count))
        while len(self._marks) > 2 and self._marks[1][0] <= now - RATE_SEC:
            self._marks.popleft()

    def rate(self, now: float) -> float:
        """Return the rate, Hz."""
        if len(self._marks) < 2:
            return 0.0
        (begin, before), (end, after) = self._marks[0], self._marks[-1]
        rate = (after - before) / (end - begin)
        return rate if now - end <= max(SILENT_SEC, 3 / rate) else 0.0


def in_hertz(rate: float) -> str:
    """Return a rate with its unit; '' for zero."""
    if not rate:
        return ''
    return f'{rate:.2g} Hz' if rate < 99.5 else f'{rate:.0f} Hz'


def way_of(line: Line) -> Way | None:
    """Return the endpoint that an arrow counts messages of; None if it counts none."""
    return (line.kind, line.node, line.other) if line.kind in ('publishes', 'hears') else None


def parts(data: Graph, picture: Drawing, whole: Graph) -> dict[str, list[str]]:
    """Return the lines of details for each part of a picture, its name first.

    Args:
        data: What is drawn.
        picture: The drawing.
        whole: The graph without a namespace folded.
    """
    topics = {topic.name: topic for topic in data.topics}
    found = {
        f'b{number}': _of_shape(shape, data, topics, whole)
        for number, shape in enumerate(picture.shapes)
    }
    for number, line in enumerate(picture.lines):
        found[f'a{number}'] = _of_line(line, topics)
    return found


def _of_shape(
    shape: Shape, data: Graph, topics: Mapping[str, GraphTopic], whole: Graph
) -> list[str]:
    if shape.kind == 'topic':
        topic = topics[shape.name]
        return [
            f'Topic {shape.name}',
            *(f'Type: {name}' for name in topic.types),
            *_ends('Published by', topic.publishers),
            *_ends('Subscribed by', topic.subscriptions),
            *_faults(topic.name),
        ]
    if shape.kind == 'node':
        lines = [f'Node {shape.name}']
        names = [shape.name]
        if shape.name.endswith('/*'):
            space = shape.name.removesuffix('*')
            names = [node.name for node in whole.nodes if node.name.startswith(space)]
            lines = [f'Namespace {space.rstrip("/")}', f'Nodes: {", ".join(names)}']
        lines += [] if shape.own else ['In another process']
        for words, attribute in (('Publishes', 'publishers'), ('Subscribes to', 'subscriptions')):
            found = [
                topic.name
                for topic in data.topics
                if shape.name in {end.node for end in getattr(topic, attribute)}
            ]
            lines += [f'{words}: {", ".join(found)}'] if found else []
        lines = lines if len(lines) > 1 else [*lines, 'It neither publishes nor subscribes']
        return [*lines, *dict.fromkeys(line for name in names for line in _faults(name))]
    return [f'{shape.kind.capitalize()} {shape.name}', *(f'Type: {line}' for line in shape.small)]


def _faults(name: str) -> list[str]:
    """Return what is told about a node or a topic."""
    return [line for fault in seen_about(name) for line in (f'⚠ {fault}', f'→ {fault.advice}')]


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
    """Return type and QoS of a node's endpoints, without duplicates."""
    return list(
        dict.fromkeys(
            f'{end.msg_type}, {_word(end.qos.reliability.name)}, {_word(end.qos.durability.name)}'
            for end in ends
        )
    )


def _word(name: str) -> str:
    return name.lower().replace('_', ' ')
