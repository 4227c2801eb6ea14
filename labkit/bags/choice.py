"""Which topics of the graph are recorded, in the terms of the real `ros2 bag record`."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

from rclpy.node import Node

from labkit.errors import LabError
from labkit.rosgraph.listings import topics as topics_of
from labkit.rosgraph.names import full_topic_name, is_hidden

__all__ = ['TopicChoice', 'choose']


@dataclass(frozen=True)
class TopicChoice:
    """Which topics are meant. Hidden ones only if they are named, or asked for.

    Attributes:
        everything: Whether all are; then names, types and `regex` say nothing.
        names: Full names of topics.
        types: Names of types: their topics, too.
        regex: A pattern: topics whose name contains it, too.
        exclude: Patterns: not the topics whose name contains one of them.
        exclude_names: Not these.
        exclude_types: Not those of these types.
        hidden: Whether hidden topics are meant, too.
    """

    everything: bool = True
    names: Collection[str] = ()
    types: Collection[str] = ()
    regex: str = ''
    exclude: Sequence[str] = ()
    exclude_names: Collection[str] = ()
    exclude_types: Collection[str] = ()
    hidden: bool = False

    def __post_init__(self) -> None:
        for pattern in (self.regex, *self.exclude):
            try:
                re.compile(pattern)
            except re.error as error:
                raise LabError(
                    f'{pattern!r} is no regular expression: {error}.',
                    todo="In one, .* stands for anything: '/robot/.*' is all that begins with "
                    '/robot/.',
                ) from error

    def takes(self, name: str, msg_type: str) -> bool:
        """Tell whether a topic is meant."""
        if name in self.names:
            wanted = True
        elif is_hidden(name) and not self.hidden:
            return False
        else:
            matches = bool(self.regex) and re.search(self.regex, name) is not None
            wanted = self.everything or msg_type in self.types or matches
        left_out = name in self.exclude_names or msg_type in self.exclude_types
        return (
            wanted
            and not left_out
            and not any(re.search(pattern, name) for pattern in self.exclude)
        )

    def found(self, node: Node) -> list[tuple[str, list[str]]]:
        """Return the topics that somebody publishes and that are meant, with their types."""
        return [
            (name, types)
            for name, types in topics_of(node, include_hidden=True)
            if self.takes(name, types[0]) and node.count_publishers(name)
        ]


def choose(
    node: Node,
    topics: str | Iterable[str] | None,
    regex: str | None = None,
    exclude: str | Iterable[str] | None = None,
) -> TopicChoice:
    """Return which topics are meant.

    Args:
        node: The node whose name and namespace complete a name.
        topics: A name, or several; all if None and `regex` is None.
        regex: A pattern: topics whose name contains it.
        exclude: A pattern, or several: not the topics whose name contains it.

    Raises:
        LabError: It is no name of a topic, or no pattern.
    """
    names = [topics] if isinstance(topics, str) else topics
    try:
        wanted = frozenset(full_topic_name(name, node) for name in names or ())
    except TypeError as error:
        raise LabError(
            f'topics must be a name, a list of names, or None for all, but it is {topics!r}.',
            todo="Write topics=['/odom', '/scan'].",
        ) from error
    patterns = [exclude] if isinstance(exclude, str) else list(exclude or ())
    everything = names is None and regex is None
    return TopicChoice(everything, wanted, regex=regex or '', exclude=patterns)
