"""The selection of topics to record, in the terms of the real `ros2 bag record`."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

from rclpy.node import Node

from labkit.errors import LabError, quoted
from labkit.rosgraph.listings import topics as topics_of
from labkit.rosgraph.names import full_topic_name, is_hidden

__all__ = ['SERVICE_EVENTS', 'TopicChoice', 'choose']

# End of the topic's name on which a service with introspection tells what happens.
SERVICE_EVENTS = '/_service_event'


@dataclass(frozen=True)
class TopicChoice:
    """A selection of topics. Hidden ones only if they are named, or requested.

    Attributes:
        everything: Whether all topics are selected; then names, types and `regex` are ignored.
        names: Full names of topics.
        types: Types of topics to add.
        regex: Pattern: topics with matching names are added.
        exclude: Patterns: topics with matching names are left out.
        exclude_names: Names of topics to leave out.
        exclude_types: Types of topics to leave out.
        hidden: Whether to include hidden topics.
        services: Whether to include the events of all services with introspection.
    """

    everything: bool = True
    names: Collection[str] = ()
    types: Collection[str] = ()
    regex: str = ''
    exclude: Sequence[str] = ()
    exclude_names: Collection[str] = ()
    exclude_types: Collection[str] = ()
    hidden: bool = False
    services: bool = False

    def __post_init__(self) -> None:
        for pattern in (self.regex, *self.exclude):
            try:
                re.compile(pattern)
            except re.error as error:
                raise LabError(
                    f'{quoted(pattern)} is no regular expression: {error}.',
                    todo="In one, .* stands for anything: '/robot/.*' is all that begins with "
                    '/robot/.',
                ) from error

    def takes(self, name: str, msg_type: str) -> bool:
        """Return whether a topic is selected."""
        if name in self.names or (self.services and name.endswith(SERVICE_EVENTS)):
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
        """Return the selected topics that have publishers, with their types."""
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
    """Return a selection of topics.

    Args:
        node: The node whose name and namespace complete the names.
        topics: One name or several; all topics if None and `regex` is None.
        regex: Pattern: topics with matching names.
        exclude: One pattern or several: leave out topics with matching names.

    Raises:
        LabError: A name or a pattern is invalid.
    """
    names = [topics] if isinstance(topics, str) else topics
    try:
        wanted = frozenset(full_topic_name(name, node) for name in names or ())
    except TypeError as error:
        raise LabError(
            'topics must be a name, a list of names, or None for all, but it is '
            f'{quoted(topics)}.',
            todo="Write topics=['/odom', '/scan'].",
        ) from error
    patterns = [exclude] if isinstance(exclude, str) else list(exclude or ())
    everything = names is None and regex is None
    return TopicChoice(everything, wanted, regex=regex or '', exclude=patterns)
