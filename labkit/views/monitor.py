"""What comes on one topic, live: `lab.monitor(topic)`.

The last message as a tree, how often messages come, who publishes them, and when none comes, why.
Messages are taken as bytes; only one that is shown is made into a Python object.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from labkit.background.runtime import runtime
from labkit.errors import LabError
from labkit.rosgraph.endpoints import Endpoint
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.names import UNKNOWN_NODE
from labkit.views.feed import Feed, checked_type
from labkit.views.live import Live, heard, page_widget
from labkit.views.message_tree import as_text, rows

if TYPE_CHECKING:
    from rclpy.qos import QoSProfile

__all__ = ['Monitor', 'monitor']

# What changes more often than this can't be read, s.
READ_SEC = 0.1

_Page = page_widget('monitor')


class Monitor(Live):
    """A live view of one topic, to be shown in a cell; see `monitor`.

    Attributes:
        topic: Full name of the topic.
    """

    _what = 'monitor'

    def __init__(
        self, topic: str, *, msg_type: Any, qos_profile: QoSProfile | int | None, count: int
    ) -> None:
        if not isinstance(count, int) or count < 1:
            raise LabError(f'count must be a whole number of at least 1, but it is {count!r}.')
        runtime.start()
        self._options = {'msg_type': checked_type(msg_type), 'qos_profile': qos_profile}
        self._feed = self._new_feed(topic, self._take)
        self.topic = self._feed.topic
        self._last: tuple[Any, bytes] | None = None
        # What the page was told last, and when.
        self._told: dict[str, Any] = {}
        self._told_at = 0.0
        super().__init__(_Page, [self._feed])
        self._wanted = count
        self._text = self._still() if self._widget is None else ''

    @property
    def count(self) -> int:
        """Return how many messages have come while somebody looked on."""
        return self._feed.count

    def __repr__(self) -> str:
        return self._text or self._still()

    def _repr_mimebundle_(self, **_: object) -> dict[str, Any]:
        if self._widget is None:
            return {'text/plain': self._text}
        words = f'Monitor of {self.topic}: live, for as long as a page shows it.'
        return {**self._page_bundle(), 'text/plain': words}

    def _new_feed(self, topic: str, take: Any) -> Feed:
        assert runtime.helper is not None
        return Feed(topic, runtime.helper, take, raw=True, **self._options)

    def _take(self, data: bytes) -> None:
        self._last = (self._feed.msg_type, data)

    def _still(self) -> str:
        """Wait for messages; return the last of them as text that is the same each time."""
        messages: list[bytes] = []
        feed = self._new_feed(self.topic, messages.append)
        with heard([feed], lambda: len(messages) >= self._wanted):
            if not messages:
                return f'{self.topic}: no message came. {feed.silence()}'.strip()
            ends = ', '.join(f'{name} ({", ".join(qos)})' for name, *qos in _told(feed.publishers))
            lines = [f'{self.topic} [{type_name(feed.msg_type)}]']
            lines += [f'published by {ends}'] if ends else []
            if self._wanted > 1:
                lines += [f'message {min(len(messages), self._wanted)} of {self._wanted}:']
            message = _message(feed.msg_type, messages[: self._wanted][-1])
            return '\n'.join([*lines, as_text(rows(message, no_time=True))])

    def _news(self, everything: bool) -> tuple[dict[str, Any], list[bytes]]:
        now = time.monotonic()
        if everything:
            self._told = {}
        elif now - self._told_at < READ_SEC:
            return {}, []
        feed, self._told_at = self._feed, now
        rate = feed.rate()
        state: dict[str, Any] = {
            'topic': self.topic,
            'type': type_name(feed.msg_type) if feed.msg_type else '',
            'rate': '' if rate is None else f'{rate:.3g}' if rate < 99.5 else f'{rate:.0f}',
            'note': feed.silence(),
            'publishers': _told(feed.publishers),
            'count': feed.count,
        }
        if feed.count != self._told.get('count') and self._last is not None:
            state['age'] = now - feed.heard_at
            tree = rows(_message(*self._last))
            state['fields'] = [row[:-1] for row in tree]
            state['values'] = [row.value for row in tree]
        news = {key: value for key, value in state.items() if value != self._told.get(key)}
        self._told.update(state)
        return news, []


def monitor(
    topic: str,
    *,
    msg_type: Any = None,
    qos_profile: QoSProfile | int | None = None,
    count: int = 1,
) -> Monitor:
    """Show what comes on a topic: the last message, how often, from whom, or why nothing comes.

    It is live in a notebook, and listens for as long as it can be seen. Elsewhere it is a text
    that tells the next message.

    Args:
        topic: Name of the topic. It need not exist yet.
        msg_type: Class of its messages, or its name. By default that of the publishers.
        qos_profile: QoS profile or queue depth. By default one that hears all publishers.
        count: For the text: how many messages to wait for. The last of them is shown.

    Returns:
        What a cell shows. `.close()` ends it.

    Raises:
        LabError: `topic` is no name of a topic, or there is no such type.
    """
    return Monitor(topic, msg_type=msg_type, qos_profile=qos_profile, count=count)


def _message(msg_type: Any, data: bytes) -> Any:
    from rclpy.serialization import deserialize_message

    return deserialize_message(data, msg_type)


def _told(publishers: tuple[Endpoint, ...]) -> list[list[str]]:
    """Return publishers as name, reliability and durability."""
    return [
        [_name(end), *(_word(policy) for policy in (end.qos.reliability, end.qos.durability))]
        for end in publishers
    ]


def _name(end: Endpoint) -> str:
    return 'not known yet' if UNKNOWN_NODE in end.node else end.node


def _word(policy: Any) -> str:
    return str(policy.name).lower().replace('_', ' ')
