"""One topic as a view hears it: from the moment it appears, with a QoS that all publishers offer.

Also what a person wants to know besides the messages: how many came and how often, who publishes,
and why nothing comes.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from labkit.background.compat import RCLError
from labkit.background.discovery import alone, asking_node
from labkit.background.nodes import node_exists
from labkit.background.runtime import runtime
from labkit.errors import LabError
from labkit.rosgraph.endpoints import Endpoint, publishers
from labkit.rosgraph.interfaces import message_class, type_name
from labkit.rosgraph.matching import nobody_publishes, other_type_here, why_silent
from labkit.rosgraph.names import full_topic_name
from labkit.rosgraph.qos import match_all

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile
    from rclpy.subscription import Subscription

__all__ = ['STILL_SEC', 'Feed', 'checked_type', 'heard']

DEPTH = 100
# The rate is that of the last messages of so many seconds, and of the last two at least.
RATE_SEC = 2.0
# A topic is said to be silent when nothing has come for so long, in seconds.
SILENT_SEC = 1.0
# How long a still picture waits for messages, s, and for somebody to publish any: in this process,
# or in another one, which may have been started just now.
STILL_SEC = 4.0
NOBODY_SEC = 1.0
NOBODY_ELSEWHERE_SEC = 3.0


class Feed:
    """The messages of one topic, for as long as it is open.

    Args:
        topic: Name of the topic, which need not exist yet.
        node: The node that knows its full name.
        take: Called in the background with each message.
        msg_type: Class of the messages; None to take that of the publishers.
        qos_profile: QoS profile of the subscription; None for one that hears all publishers.
        raw: Whether `take` gets serialized messages.

    Attributes:
        topic: Full name of the topic.
        msg_type: Class of the messages; None as long as it is not known.
        publishers: Who publishes there.
        count: How many messages have come.
        heard_at: When the last one came, as `time.monotonic()` tells it.

    Raises:
        LabError: It is no name of a topic.
    """

    def __init__(
        self,
        topic: str,
        node: Node,
        take: Callable[[Any], None],
        *,
        msg_type: type | None = None,
        qos_profile: QoSProfile | int | None = None,
        raw: bool = False,
    ) -> None:
        self.topic = full_topic_name(topic, node)
        self.msg_type = self._wanted = msg_type
        self.publishers: tuple[Endpoint, ...] = ()
        self.count = 0
        self.heard_at = 0.0
        self._profile_wanted, self._raw = qos_profile, raw
        self._take = take
        self._node: Node | None = None
        self._subscription: Subscription | None = None
        self._profile: QoSProfile | None = None
        self._problem = ''
        self._changed_at = 0.0
        # Moments and how many messages had come by then.
        self._marks: deque[tuple[float, int]] = deque()

    # -- listening ------------------------------------------------------------------------------

    def open(self, node: Node) -> None:
        """Listen from now on, if there is something to listen to."""
        self._node = node
        self._marks.clear()
        self._changed_at = time.monotonic()
        self.look()

    def close(self) -> None:
        """Listen no more."""
        self._unsubscribe()
        self._node = None

    @property
    def is_open(self) -> bool:
        """Tell whether it listens, or waits for something to listen to."""
        return self._node is not None

    @property
    def has_new_publishers(self) -> bool:
        """Tell whether publishers have come or gone since the last look."""
        assert self._node is not None
        return self._node.count_publishers(self.topic) != len(self.publishers)

    @property
    def is_settled(self) -> bool:
        """Tell whether the last look has seen all publishers, and the names of their nodes."""
        return not self.has_new_publishers and all(end.is_known for end in self.publishers)

    @property
    def is_promising(self) -> bool:
        """Tell whether somebody publishes what is listened to."""
        return self._subscription is not None and bool(self.publishers)

    def look(self) -> None:
        """Look who publishes, and subscribe, subscribe anew or no more if that asks for it."""
        if self._node is None or not node_exists(self._node):
            return
        seen = publishers(self._node, self.topic)
        if seen != self.publishers:
            self.publishers, self._changed_at = seen, time.monotonic()
        self._problem = ''
        try:
            msg_type = self._type_to_hear()
        except LabError as error:
            msg_type, self._problem = None, str(error)
        if msg_type is None:
            self._unsubscribe()
            return
        self.msg_type = msg_type
        profile = self._profile_to_use()
        wanted = (msg_type, profile.reliability, profile.durability)
        if wanted != self._heard_as():
            self._unsubscribe()
            self._subscribe(profile)

    def _type_to_hear(self) -> type | None:
        """Return the class to subscribe to, None if it is not the time to."""
        types = sorted({end.msg_type for end in self.publishers})
        if self._wanted is not None:
            # In one process, a publisher of another type would keep it from subscribing.
            return self._wanted if not types or type_name(self._wanted) in types else None
        if len(types) > 1:
            raise LabError(
                f'{self.topic} has messages of more than one type: {", ".join(types)}.',
                todo=f'Name the one that you want: msg_type={types[0]!r}.',
            )
        return message_class(types[0]) if types else None

    def _profile_to_use(self) -> QoSProfile:
        from rclpy.qos import QoSProfile

        if isinstance(self._profile_wanted, QoSProfile):
            return self._profile_wanted
        profile = QoSProfile(depth=self._profile_wanted or DEPTH)  # type: ignore[no-untyped-call]
        name = type_name(self.msg_type)
        offered = [end.qos for end in self.publishers if end.msg_type == name]
        if offered and self._profile_wanted is None:
            match_all(profile, offered)
        return profile

    def _heard_as(self) -> tuple[object, ...] | None:
        if self._subscription is None or self._profile is None:
            return None
        profile = self._profile
        return self._subscription.msg_type, profile.reliability, profile.durability

    def _subscribe(self, profile: QoSProfile) -> None:
        from rclpy.event_handler import SubscriptionEventCallbacks

        assert self._node is not None
        self._profile = profile
        try:
            self._subscription = self._node.create_subscription(
                self.msg_type,
                self.topic,
                self._on_message,
                profile,
                # A view says itself what does not fit.
                event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
                raw=self._raw,
            )
        except (RCLError, LabError) as error:
            self._problem = other_type_here(self._node, self.topic, self.msg_type) or str(error)

    def _unsubscribe(self) -> None:
        if self._subscription is not None and self._node is not None and node_exists(self._node):
            self._node.destroy_subscription(self._subscription)
        self._subscription = None

    def _on_message(self, message: Any) -> None:
        # As light as can be: it may be called thousands of times a second.
        self.count += 1
        self.heard_at = time.monotonic()
        self._take(message)

    # -- what there is to say -------------------------------------------------------------------

    def rate(self) -> float | None:
        """Return how many messages come in a second; None as long as that is not known.

        To be asked several times a second.
        """
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

    def silence(self) -> str:
        """Return why nothing comes and what to do, '' as long as all is well."""
        since = time.monotonic() - max(self.heard_at, self._changed_at)
        if self._node is None or not node_exists(self._node):
            return ''
        if self._problem:
            return self._problem
        if not self.publishers:
            return nobody_publishes(self._node, self.topic)
        if self.msg_type is None or (self._subscription is not None and since < SILENT_SEC):
            return ''
        interval = 1 / (self.rate() or 1)
        if self.count and since < 3 * interval and self._subscription is not None:
            return ''
        return why_silent(self._node, self.topic, self.msg_type, self._profile_to_use())


@contextmanager
def heard(
    feeds: Sequence[Feed], enough: Callable[[], object], *, timeout_sec: float = STILL_SEC
) -> Iterator[None]:
    """Wait for messages of topics; they stay open for as long as a `with` block lasts.

    Args:
        feeds: The topics. Those that are open stay so.
        enough: Tells whether there are enough messages. Waiting ends too when time is over, or
            when nobody publishes one of the topics.
        timeout_sec: Seconds to wait.
    """
    node = asking_node()
    begin, patience = time.monotonic(), NOBODY_SEC if alone() else NOBODY_ELSEWHERE_SEC

    def done() -> bool:
        for feed in feeds:
            if not feed.is_settled:
                feed.look()
        late = time.monotonic() - begin > patience
        settled = all(feed.is_settled for feed in feeds)
        return bool(settled and enough()) or (
            late and not all(feed.is_promising for feed in feeds)
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
    """Return the class that a learner names: a class, `'std_msgs/msg/String'`, or None.

    Raises:
        LabError: There is no such type.
    """
    if isinstance(msg_type, str):
        found: type = message_class(msg_type)
        return found
    if msg_type is None or hasattr(msg_type, 'get_fields_and_field_types'):
        return msg_type
    raise LabError(
        f'msg_type must be a message class, or the name of one, but it is {msg_type!r}.',
        todo="Write msg_type='std_msgs/msg/String', or leave it out.",
    )
