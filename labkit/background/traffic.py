"""How many messages pass, for a picture that shows it, without a part in what is looked at.

What the nodes of this process publish is counted where they call `publish()`, and what they hear
where the executor has called their callbacks: no subscription, so that a graph looks the same
whether it is watched or not. Counting costs less than a microsecond a message, and nothing when
nobody watches.

Publishers of other processes can only be heard. A hidden node subscribes to their topics, best
effort, with a short queue, and not in the executor: the queue is emptied ten times a second, and
what was too much for it is never seen by Python. While a cell runs it does not subscribe, so that
neither a check, nor `ros2 topic info`, nor a count of subscribers sees it.
"""

from __future__ import annotations

import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

from rclpy.exceptions import InvalidHandle
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from labkit import settings
from labkit.background import compat
from labkit.background.nodes import existing_nodes, full_name, helper_node
from labkit.background.runtime import runtime
from labkit.errors import LabError
from labkit.rosgraph.endpoints import Endpoint
from labkit.rosgraph.interfaces import message_class
from labkit.rosgraph.matching import why_apart
from labkit.rosgraph.snapshot import GraphTopic
from labkit.rosgraph.whose import is_own

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.subscription import Subscription

__all__ = ['Traffic', 'Way']

# So many messages of a topic are counted at a time at most.
QUEUE = 20

_published: WeakKeyDictionary[Publisher, int] = WeakKeyDictionary()
# Those that count at this moment, and the method that they have replaced.
_open: set[Traffic] = set()
_original: Callable[[Publisher, Any], None] = Publisher.publish

# What passes: `'publishes'` or `'hears'`, a node and a topic.
Way = tuple[str, str, str]


def _publish(publisher: Publisher, msg: Any) -> None:
    _original(publisher, msg)
    _published[publisher] = _published.get(publisher, 0) + 1


class Traffic:
    """Counts the messages that pass between nodes, as long as it is open."""

    def __init__(self) -> None:
        # A page's thread and that of ROS. Nothing else is waited for while it is held.
        self._lock = threading.Lock()
        self._resting = False
        # Publisher or subscription -> how many of its messages are told already.
        self._told: WeakKeyDictionary[Any, int] = WeakKeyDictionary()
        self._listener: Node | None = None
        self._heard: dict[str, Subscription] = {}

    def open(self) -> None:
        """Count from now on."""
        if self in _open:
            return
        if not _open:
            Publisher.publish = _publish  # type: ignore[method-assign, assignment]
        _open.add(self)
        for event, function in self._at_cells():
            _events().register(event, function)
        # What has passed before is no news.
        self._told.update({end: count for _, end, count in self._counts()})

    def close(self) -> None:
        """Count no more."""
        self._forget_others()
        if self in _open:
            _open.remove(self)
            for event, function in self._at_cells():
                _events().unregister(event, function)
            if not _open:
                Publisher.publish = _original  # type: ignore[method-assign, assignment]
                _published.clear()

    def listen_to_others(self, topics: Iterable[GraphTopic]) -> None:
        """Subscribe to the topics on which other processes publish, and to no more.

        Args:
            topics: The topics as they are now.
        """
        wanted = {topic.name: kind for topic in topics if (kind := _type_to_hear(topic))}
        with self._lock:
            if self._resting:
                return
            for name in self._heard.keys() - wanted.keys():
                self._drop(name)
            for name in wanted.keys() - self._heard.keys():
                self._subscribe(name, wanted[name])

    def passed(self, topics: Iterable[GraphTopic]) -> dict[Way, int]:
        """Return how many messages have passed since the last time.

        Which of several publishers of other processes has sent a message can't be told: it is
        counted for none of them.

        Args:
            topics: The topics as they are now.
        """
        topics = tuple(topics)
        names = {topic.name for topic in topics}
        new: Counter[Way] = Counter()
        for way, end, count in self._counts():
            if way[2] in names:
                new[way] += max(0, count - self._told.get(end, 0))
                self._told[end] = count
        for topic in topics:
            self._add_others(topic, new)
        return {way: count for way, count in new.items() if count}

    # -- in this process ------------------------------------------------------------------------

    def _counts(self) -> Iterator[tuple[Way, Any, int]]:
        """Yield each publisher and subscription of this process, and what has passed it."""
        entries = {entry.node: entry for entry in runtime.nodes()}
        for node in existing_nodes():
            name = full_name(node)
            # Whatever is destroyed meanwhile has nothing more to tell.
            with suppress(InvalidHandle):
                for publisher in list(node.publishers):
                    way = ('publishes', name, publisher.topic_name)
                    yield way, publisher, _published.get(publisher, 0)
                entry = entries.get(node)
                for subscription in list(node.subscriptions) if entry is not None else ():
                    assert entry is not None
                    way = ('hears', name, subscription.topic_name)
                    yield way, subscription, entry.counts.get(subscription, 0)

    # -- in other processes ---------------------------------------------------------------------

    def _at_cells(self) -> list[tuple[str, Callable[..., None]]]:
        """Return what is done when a cell begins, and when it has ended."""
        if not settings.in_kernel():
            return []
        return [('pre_run_cell', self._rest), ('post_run_cell', self._go_on)]

    def _rest(self, *_: object) -> None:
        self._resting = True
        self._forget_others()

    def _go_on(self, *_: object) -> None:
        self._resting = False

    def _forget_others(self) -> None:
        """Subscribe to nothing."""
        with self._lock:
            listener, self._listener = self._listener, None
            self._heard.clear()
            if listener is not None:
                # No other view is told, which might be waiting for this one.
                listener.destroy_node()  # type: ignore[no-untyped-call]

    def _subscribe(self, topic: str, kind: str) -> None:
        if self._listener is None:
            assert runtime.helper is not None
            self._listener = helper_node('_labkit_traffic', context=runtime.helper.context)
        profile = QoSProfile(  # type: ignore[no-untyped-call]
            depth=QUEUE,
            reliability=ReliabilityPolicy.BEST_EFFORT,
            durability=DurabilityPolicy.VOLATILE,
        )
        # A type that is not installed here, or of which there is another one in this process.
        with suppress(LabError, compat.RCLError):
            self._heard[topic] = self._listener.create_subscription(
                message_class(kind), topic, lambda data: None, profile, raw=True
            )

    def _drop(self, topic: str) -> None:
        subscription = self._heard.pop(topic)
        if self._listener is not None:
            self._listener.destroy_subscription(subscription)

    def _add_others(self, topic: GraphTopic, new: Counter[Way]) -> None:
        """Add what other processes have sent on a topic, and what they hear of it."""
        own = {end.node: _is_here(end) for end in (*topic.publishers, *topic.subscriptions)}
        sent = {node: new['publishes', node, topic.name] for node, here in own.items() if here}
        with self._lock:
            subscription = self._heard.get(topic.name)
            heard = compat.take_all(subscription, QUEUE) if subscription is not None else 0
        # It hears those of this process too.
        foreign = max(0, heard - sum(sent.values()))
        others = {end.node for end in topic.publishers if not own[end.node]}
        if len(others) == 1:
            new['publishes', others.pop(), topic.name] += foreign
        for end in topic.subscriptions:
            if not own[end.node]:
                matched = [other for other in topic.publishers if not why_apart(other, end)]
                here = {other.node for other in matched if own[other.node]}
                count = sum(sent[node] for node in here)
                count += foreign if len(here) < len({other.node for other in matched}) else 0
                new['hears', end.node, topic.name] += count


def _events() -> Any:
    """Return what tells when a cell begins and ends."""
    return sys.modules['IPython'].get_ipython().events


def _is_here(end: Endpoint) -> bool:
    """Tell whether a publisher or subscription belongs to this process."""
    assert runtime.helper is not None
    return is_own(end.gid, runtime.helper)


def _type_to_hear(topic: GraphTopic) -> str:
    """Return the type of what other processes publish; '' if none does, or there are several."""
    kinds = {end.msg_type for end in (*topic.publishers, *topic.subscriptions)}
    foreign = any(not _is_here(end) for end in topic.publishers)
    return kinds.pop() if foreign and len(kinds) == 1 else ''
