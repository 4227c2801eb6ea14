"""What comes on one topic, live: `lab.monitor(topic)`.

The last message as a tree, how often messages come, who publishes them, and when none comes, why.
Messages are taken as bytes; only one that is shown is made into a Python object.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from labkit.errors import LabError
from labkit.rosgraph.endpoints import Endpoint
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.names import UNKNOWN_NODE
from labkit.views.feed import Feed, checked_type, heard
from labkit.views.live import helper
from labkit.views.live_page import LivePage, News
from labkit.views.message_tree import as_text, rows

if TYPE_CHECKING:
    from enum import Enum

    from rclpy.qos import QoSProfile

__all__ = ['Monitor', 'monitor']


class Monitor(LivePage):
    """A live view of one topic, to be shown in a cell; see `monitor`.

    Attributes:
        topic: Full name of the topic.
    """

    _name = 'monitor'
    # What changes more often can't be read.
    _period = 0.1

    def __init__(
        self,
        topic: str,
        *,
        msg_type: type | str | None,
        qos_profile: QoSProfile | int | None,
        count: int,
    ) -> None:
        if not isinstance(count, int) or count < 1:
            raise LabError(f'count must be a whole number of at least 1, but it is {count!r}.')
        self._msg_type, self._qos_profile = checked_type(msg_type), qos_profile
        self._feed = self._new_feed(topic, self._take)
        self.topic = self._feed.topic
        self._last_message: tuple[type | None, bytes] | None = None
        self._wanted = count
        super().__init__([self._feed])
        self._text = '' if self._watched else self._heard_text()

    @property
    def count(self) -> int:
        """Return how many messages have come while somebody looked on."""
        return self._feed.count

    def __repr__(self) -> str:
        return self._text or self._heard_text()

    def _still(self) -> dict[str, str]:
        return {'text/plain': self._text or self._known_text()}

    def _known_text(self) -> str:
        """Return the last message as text, and how many have come."""
        feed = self._feed
        if self._last_message is None:
            return f'{self.topic}: no message has come.'
        return '\n'.join(
            [
                f'{self.topic} [{type_name(feed.msg_type)}]',
                f'message {feed.count}:',
                as_text(rows(_message(*self._last_message))),
            ]
        )

    def _new_feed(self, topic: str, take: Callable[[bytes], None]) -> Feed:
        return Feed(
            topic,
            helper(),
            take,
            msg_type=self._msg_type,
            qos_profile=self._qos_profile,
            raw=True,
        )

    def _take(self, data: bytes) -> None:
        self._last_message = (self._feed.msg_type, data)

    def _heard_text(self) -> str:
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

    def _news(self, everything: bool) -> News:
        now, feed = time.monotonic(), self._feed
        rate = feed.rate()
        state: dict[str, Any] = {
            'topic': self.topic,
            'type': type_name(feed.msg_type) if feed.msg_type else '',
            'rate': '' if rate is None else f'{rate:.3g}' if rate < 99.5 else f'{rate:.0f}',
            'note': feed.silence(),
            'publishers': _told(feed.publishers),
            'count': feed.count,
        }
        if feed.count != self._told.get('count') and self._last_message is not None:
            state['age'] = now - feed.heard_at
            tree = rows(_message(*self._last_message))
            state['fields'] = [row[:-1] for row in tree]
            state['values'] = [row.value for row in tree]
        return self._new_of(state), []


def monitor(
    topic: str,
    *,
    msg_type: type | str | None = None,
    qos_profile: QoSProfile | int | None = None,
    count: int = 1,
) -> Monitor:
    """Show what comes on a topic: the last message, how often, from whom, or why nothing comes.

    It is live in a notebook, and listens for as long as it can be seen. Elsewhere it is a text
    that tells the next message.

    Args:
        topic: Name of the topic. It need not exist yet.
        msg_type: Class of its messages, or its name. By default that of the publishers.
        qos_profile: QoS profile, or queue depth in messages. By default one that hears all
            publishers.
        count: For the text: how many messages to wait for. The last of them is shown.

    Returns:
        What a cell shows. `.close()` ends it.

    Raises:
        LabError: `topic` is no name of a topic, there is no such type, or `count` is no number
            of messages.
    """
    return Monitor(topic, msg_type=msg_type, qos_profile=qos_profile, count=count)


def _message(msg_type: type | None, data: bytes) -> Any:
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


def _word(policy: Enum) -> str:
    return str(policy.name).lower().replace('_', ' ')
