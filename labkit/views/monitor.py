"""A live view of one topic: `lab.monitor(topic)`.

The last message as a tree, the rate and its course over the last minute, the publishers, and the
reason for silence. Messages arrive as bytes; only one that is shown is deserialized.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Collection
from typing import TYPE_CHECKING, Any

from labkit.errors import LabError, quoted
from labkit.rosgraph.endpoints import Endpoint
from labkit.rosgraph.interfaces import type_name
from labkit.rosgraph.names import UNKNOWN_NODE
from labkit.views.feed import Feed, checked_type, subscribed
from labkit.views.live import helper
from labkit.views.live_page import LivePage, Update
from labkit.views.message_tree import as_text, rows
from labkit.views.timed_out import TimedOut

if TYPE_CHECKING:
    from enum import Enum

    from rclpy.qos import QoSProfile

__all__ = ['Monitor', 'monitor']

# Topics at which one looks when a robot stands.
_OF_ROBOTS = ('cmd_vel', 'odom')
# The course of the rate: so many samples, and the time between two, s.
SAMPLES, SAMPLE_SEC = 60, 1.0


class Monitor(LivePage):
    """A live view of one topic, to be shown in a cell; see `monitor`.

    Attributes:
        topic: Full name of the topic.
    """

    _name = 'monitor'
    # Faster changes can't be read.
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
            raise LabError(
                f'count must be a whole number of at least 1, but it is {quoted(count)}.'
            )
        self._msg_type, self._qos_profile = checked_type(msg_type), qos_profile
        self._feed = self._new_feed(topic, self._on_message_bytes)
        self.topic = self._feed.topic
        self._last_message: tuple[type | None, bytes] | None = None
        self._wanted = count
        self._rates: deque[float] = deque(maxlen=SAMPLES)
        self._sampled_at = 0.0
        self._timed_out = _timed_out_beside(self.topic)
        super().__init__([self._feed, *self._timed_out])
        self._text = '' if self._watched else self._wait_for_text()

    @property
    def count(self) -> int:
        """Number of messages received while the view was visible."""
        return self._feed.count

    def __repr__(self) -> str:
        return self._text or self._wait_for_text()

    def _static(self) -> dict[str, str]:
        return {'text/plain': self._text or self._stored_text()}

    def _stored_text(self) -> str:
        """Return the last message as text, and the count."""
        feed = self._feed
        if self._last_message is None:
            return '\n'.join([f'{self.topic}: no message has come.', *_standing(self._timed_out)])
        return '\n'.join(
            [
                f'{self.topic} [{type_name(feed.msg_type)}]',
                f'message {feed.count}:',
                as_text(rows(_message(*self._last_message))),
                *_standing(self._timed_out),
            ]
        )

    def _open(self) -> None:
        with self._lock:
            super()._open()
            # While nobody looked, nothing was counted.
            self._rates.clear()
            self._sampled_at = time.monotonic()

    def _new_feed(self, topic: str, callback: Callable[[bytes], None]) -> Feed:
        return Feed(
            topic,
            helper(),
            callback,
            msg_type=self._msg_type,
            qos_profile=self._qos_profile,
            raw=True,
        )

    def _on_message_bytes(self, data: bytes) -> None:
        self._last_message = (self._feed.msg_type, data)

    def _wait_for_text(self) -> str:
        """Wait for messages; return the last one as text that is the same each time."""
        messages: list[bytes] = []
        feed = self._new_feed(self.topic, messages.append)
        timed_out = _timed_out_beside(self.topic)

        def enough() -> bool:
            return len(messages) >= self._wanted and all(one.is_heard for one in timed_out)

        with subscribed([feed, *timed_out], enough):
            standing = _standing(timed_out)
            if not messages:
                why = ' '.join([feed.silence(guess=not standing), *standing])
                return f'{self.topic}: no message came. {why}'.strip()
            ends = ', '.join(
                f'{name} ({", ".join(qos)})' for name, *qos in _publisher_rows(feed.publishers)
            )
            lines = [f'{self.topic} [{type_name(feed.msg_type)}]']
            lines += [f'published by {ends}'] if ends else []
            if self._wanted > 1:
                lines += [f'message {min(len(messages), self._wanted)} of {self._wanted}:']
            message = _message(feed.msg_type, messages[: self._wanted][-1])
            return '\n'.join([*lines, as_text(rows(message, no_time=True)), *standing])

    def _update(self, everything: bool) -> Update:
        now, feed = time.monotonic(), self._feed
        known = [*_standing(self._timed_out), *_faults(self.topic, hears=bool(feed.count))]
        rate = feed.rate()
        while now - self._sampled_at >= SAMPLE_SEC:
            self._sampled_at += SAMPLE_SEC
            self._rates += [] if rate is None else [rate]
        state: dict[str, Any] = {
            'topic': self.topic,
            'type': type_name(feed.msg_type) if feed.msg_type else '',
            'rate': '' if rate is None else _number(rate),
            'course': [[round(each, 3) for each in self._rates], _range(self._rates)],
            'note': ' '.join(filter(None, [feed.silence(guess=not known), *known])),
            'publishers': _publisher_rows(feed.publishers),
            'count': feed.count,
        }
        if feed.count != self._page_state.get('count') and self._last_message is not None:
            state['age'] = now - feed.heard_at
            tree = rows(_message(*self._last_message))
            state['fields'] = [row[:-1] for row in tree]
            state['values'] = [row.value for row in tree]
        return self._changes(state), []


def monitor(
    topic: str,
    *,
    msg_type: type | str | None = None,
    qos_profile: QoSProfile | int | None = None,
    count: int = 1,
) -> Monitor:
    """Show a topic: the last message, the rate, the publishers, or why nothing arrives.

    In a notebook it is live, with the course of the rate over the last minute, and subscribes
    while it is visible. Elsewhere it is the next message as text.

    Args:
        topic: Name of the topic. It need not exist yet.
        msg_type: Class of its messages, or its name. By default the publishers' type.
        qos_profile: QoS profile, or queue depth in messages. By default one that matches all
            publishers.
        count: For the text: number of messages to wait for. The last one is shown.

    Returns:
        A view to show in a cell. `.close()` ends it.

    Raises:
        LabError: `topic` is not a valid topic name, there is no such type, or `count` is not a
            positive whole number.
    """
    return Monitor(topic, msg_type=msg_type, qos_profile=qos_profile, count=count)


def _timed_out_beside(topic: str) -> list[TimedOut]:
    is_of_robot = topic.rpartition('/')[2] in _OF_ROBOTS
    return [TimedOut(topic, helper())] if is_of_robot else []


def _standing(feeds: list[TimedOut]) -> list[str]:
    return [f'The robot stands: {feed.words}.' for feed in feeds if feed.words]


def _number(rate: float) -> str:
    return f'{rate:.3g}' if rate < 99.5 else f'{rate:.0f}'


def _range(rates: Collection[float]) -> str:
    ends = map(_number, (min(rates), max(rates))) if rates else []
    return ' to '.join(dict.fromkeys(ends))


def _faults(topic: str, *, hears: bool) -> list[str]:
    """Return what is told about a topic.

    Where two ends do not match, `Feed.silence` tells it of the view's own. With one that hears
    something, it is told of the others.
    """
    from labkit.silent.watch import seen_about

    groups = ('messages.', 'time.', 'frames.', *(('types.', 'qos.') if hears else ()))
    found = [one for one in seen_about(topic) if one.kind.id.startswith(groups)]
    return [f'{fault} {fault.advice}' for fault in found]


def _message(msg_type: type | None, data: bytes) -> Any:
    from rclpy.serialization import deserialize_message

    return deserialize_message(data, msg_type)


def _publisher_rows(publishers: tuple[Endpoint, ...]) -> list[list[str]]:
    """Return publishers as name, reliability and durability."""
    return [
        [_name(end), *(_word(policy) for policy in (end.qos.reliability, end.qos.durability))]
        for end in publishers
    ]


def _name(end: Endpoint) -> str:
    return 'not known yet' if UNKNOWN_NODE in end.node else end.node


def _word(policy: Enum) -> str:
    return str(policy.name).lower().replace('_', ' ')
