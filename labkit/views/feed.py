"""One topic as a view receives it: as soon as it appears, with QoS that matches all publishers.

It also knows how many messages arrived and how often, who publishes, and why none arrive.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from labkit.asking.discovery import asking_node, is_only_process
from labkit.asking.listener import Listener, least_profile
from labkit.asking.silence import why_silent
from labkit.background.compat import RCLError
from labkit.background.nodes import node_exists
from labkit.background.runtime import runtime
from labkit.errors import LabError, quoted
from labkit.rosgraph.endpoints import Endpoint, publishers
from labkit.rosgraph.interfaces import message_class, type_name
from labkit.rosgraph.matching import nobody_publishes, other_type_here
from labkit.rosgraph.names import full_topic_name

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile

__all__ = ['STILL_SEC', 'Feed', 'checked_type', 'subscribed']

# The rate covers the messages of this many seconds, and at least the last two.
RATE_SEC = 2.0
# A topic without messages for this long counts as silent, s.
SILENT_SEC = 1.0
# How long a still picture waits for messages, s, and for a publisher: in this process, or in
# another one, which may have just been started.
STILL_SEC = 4.0
NOBODY_SEC = 1.0
NOBODY_ELSEWHERE_SEC = 3.0


class Feed:
    """The messages of one topic while it is open.

    Args:
        topic: Name of the topic, which need not exist yet.
        node: A node that resolves the name.
        callback: Callback for each message, called in the background.
        msg_type: Class of the messages; None for the publishers' type.
        qos_profile: QoS profile of the subscription; None for one that matches all publishers.
        raw: Whether `callback` gets serialized messages.
        optional: Whether it is nothing to subscribe to, or to speak of, if nobody publishes.

    Attributes:
        topic: Full name of the topic.
        msg_type: Class of the messages; None while it is unknown.
        publishers: The publishers of the topic.
        count: Number of messages received.
        heard_at: `time.monotonic()` of the last message.

    Raises:
        LabError: The name of the topic is invalid.
    """

    def __init__(
        self,
        topic: str,
        node: Node,
        callback: Callable[[Any], None],
        *,
        msg_type: type | None = None,
        qos_profile: QoSProfile | int | None = None,
        raw: bool = False,
        optional: bool = False,
    ) -> None:
        self.topic = full_topic_name(topic, node)
        self.msg_type = self._wanted = msg_type
        self.publishers: tuple[Endpoint, ...] = ()
        self.count = 0
        self.heard_at = 0.0
        self._profile_wanted, self._raw, self._optional = qos_profile, raw, optional
        self._callback = callback
        self._node: Node | None = None
        self._listener: Listener | None = None
        self._problem = ''
        self._changed_at = 0.0
        # Pairs of a time and the count at that time.
        self._marks: deque[tuple[float, int]] = deque()

    # -- listening ------------------------------------------------------------------------------

    def open(self, node: Node) -> None:
        """Subscribe from now on, if there is anything to subscribe to."""
        self._node = node
        self._marks.clear()
        self._changed_at = time.monotonic()
        self.refresh()

    def close(self) -> None:
        """Unsubscribe."""
        self._unsubscribe()
        self._node = None

    @property
    def is_open(self) -> bool:
        """Whether it is subscribed, or waiting for a publisher."""
        return self._node is not None

    @property
    def has_new_publishers(self) -> bool:
        """Whether publishers have appeared or gone since the last refresh."""
        assert self._node is not None
        return self._node.count_publishers(self.topic) != len(self.publishers)

    @property
    def is_settled(self) -> bool:
        """Whether the last refresh saw all publishers and the names of their nodes."""
        return not self.has_new_publishers and all(end.is_known for end in self.publishers)

    @property
    def is_connected(self) -> bool:
        """Whether there is a subscription and a publisher, or need be none."""
        if self._optional and not self.publishers:
            return True
        return self._listener is not None and bool(self.publishers)

    def refresh(self) -> None:
        """Update the publishers, and subscribe, resubscribe or unsubscribe to match them."""
        if self._node is None or not node_exists(self._node):
            return
        seen = publishers(self._node, self.topic)
        if seen != self.publishers:
            self.publishers, self._changed_at = seen, time.monotonic()
        self._problem = ''
        try:
            msg_type = self._type_to_use()
        except LabError as error:
            msg_type, self._problem = None, str(error)
        if msg_type is None:
            self._unsubscribe()
            return
        self.msg_type = msg_type
        offered = [end.qos for end in self.publishers if end.msg_type == type_name(msg_type)]
        try:
            if self._listener is not None and self._listener.msg_type is msg_type:
                self._listener.follow(offered)
            else:
                self._unsubscribe()
                self._listener = Listener(
                    self._node,
                    self.topic,
                    msg_type,
                    self._on_message,
                    offered=offered,
                    qos_profile=self._profile_wanted,
                    raw=self._raw,
                )
        except (RCLError, LabError) as error:
            self._listener = None
            self._problem = other_type_here(self._node, self.topic, msg_type) or str(error)

    def _type_to_use(self) -> type | None:
        """Return the class to subscribe to, None if it is too early."""
        types = sorted({end.msg_type for end in self.publishers})
        if self._optional and not types:
            return None
        if self._wanted is not None:
            # Within one process, a publisher of another type would make subscribing fail.
            return self._wanted if not types or type_name(self._wanted) in types else None
        if len(types) > 1:
            raise LabError(
                f'{self.topic} has messages of more than one type: {", ".join(types)}.',
                todo=f'Name the one that you want: msg_type={quoted(types[0])}.',
            )
        return message_class(types[0]) if types else None

    def _unsubscribe(self) -> None:
        if self._listener is not None:
            self._listener.close()
        self._listener = None

    def _on_message(self, message: Any) -> None:
        # Keep it cheap: it may be called thousands of times a second.
        self.count += 1
        self.heard_at = time.monotonic()
        self._callback(message)

    # -- status ---------------------------------------------------------------------------------

    def rate(self) -> float | None:
        """Return the rate of messages, Hz, None while unknown; call it several times a second."""
        now = time.monotonic()
        if self.count and (not self._marks or self._marks[-1][1] != self.count):
            self._marks.append((self.heard_at, self.count))
        while len(self._marks) > 2 and self._marks[1][0] <= now - RATE_SEC:
            self._marks.popleft()
        if len(self._marks) < 2:
            return None
        (begin, before), (end, after) = self._marks[0], self._marks[-1]
        interval = (end - begin) / (after - before)
        if now - end > max(SILENT_SEC, 3 * interval):
            return 0.0
        return 1 / interval if interval > 0 else None

    def silence(self, *, guess: bool = True) -> str:
        """Return why nothing arrives and what to do, '' if all is well.

        Args:
            guess: See `why_silent`.
        """
        since = time.monotonic() - max(self.heard_at, self._changed_at)
        if self._optional or self._node is None or not node_exists(self._node):
            return ''
        if self._problem:
            return self._problem
        if not self.publishers:
            return nobody_publishes(self._node, self.topic)
        listener = self._listener
        if self.msg_type is None or (listener is not None and since < SILENT_SEC):
            return ''
        interval = 1 / (self.rate() or 1)
        if self.count and since < 3 * interval and listener is not None:
            return ''
        profile = listener.profile if listener is not None else least_profile()
        return why_silent(
            self._node, self.topic, self.msg_type, profile, patience_sec=0.0, guess=guess
        )


@contextmanager
def subscribed(
    feeds: Sequence[Feed], enough: Callable[[], object], *, timeout_sec: float = STILL_SEC
) -> Iterator[None]:
    """Wait for messages of topics, which stay open while the `with` block runs.

    Args:
        feeds: The topics. Those that are already open stay open.
        enough: Tells whether there are enough messages. Waiting also ends at the timeout, or when
            a topic has no publisher.
        timeout_sec: Seconds to wait.
    """
    node = asking_node()
    begin, patience = time.monotonic(), NOBODY_SEC if is_only_process() else NOBODY_ELSEWHERE_SEC

    def done() -> bool:
        for feed in feeds:
            if not feed.is_settled:
                feed.refresh()
        late = time.monotonic() - begin > patience
        settled = all(feed.is_settled for feed in feeds)
        return bool(settled and enough()) or (
            late and not all(feed.is_connected for feed in feeds)
        )

    closed = [feed for feed in feeds if not feed.is_open]
    for feed in closed:
        feed.open(node)
    try:
        runtime.wait(done, timeout_sec)
        yield
    finally:
        for feed in closed:
            feed.close()


def checked_type(msg_type: type | str | None) -> type | None:
    """Return the message class for a class, a name such as `'std_msgs/msg/String'`, or None.

    Raises:
        LabError: There is no such type.
    """
    if isinstance(msg_type, str):
        found: type = message_class(msg_type)
        return found
    if msg_type is None or hasattr(msg_type, 'get_fields_and_field_types'):
        return msg_type
    raise LabError(
        f'msg_type must be a message class, or the name of one, but it is {quoted(msg_type)}.',
        todo="Write msg_type='std_msgs/msg/String', or leave it out.",
    )
