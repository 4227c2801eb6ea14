"""Count the messages between nodes for live pictures, without changing the graph.

Messages of this process are counted in `publish()`, and where the executor calls callbacks. That
needs no subscription, so a graph looks the same whether it is watched or not. It costs about a
microsecond a message.

Publishers of other processes can only be counted by subscribing. A hidden node does so with best
effort and a short queue, outside the executor: the queue is emptied ten times a second, and Python
never sees what overflows it. It does not subscribe while a cell runs, so that neither a check, nor
`ros2 topic info`, nor a count of subscribers sees it.
"""

from __future__ import annotations

import functools
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakKeyDictionary

from rclpy.exceptions import InvalidHandle
from rclpy.publisher import Publisher

from labkit import settings
from labkit.asking.listener import Listener, least_profile
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

__all__ = [
    'Publication',
    'Sent',
    'Traffic',
    'Way',
    'keep_counting',
    'note_each',
    'publications',
    'sent_by',
]

# Most messages of a topic to count at a time.
QUEUE = 20
# Time from one message that is looked into to the next, s.
LOOK_SEC = 0.5


@dataclass
class Sent:
    """What a publisher has published.

    Attributes:
        count: Number of messages.
        first: `time.monotonic()` of the first one.
        last: Of the last one.
        looked_at: Of the last one that was looked at, see `keep_counting`.
        found: What was found in that.
        stamp: Time in its header, ns; None if it has none.
        frame: The frame in its header; '' if it has none.
        each: Whether each message is looked at, since one does not say what the others say.
        parts: What was noted of the parts of messages, by their names.
    """

    count: int = 0
    first: float = 0.0
    last: float = 0.0
    looked_at: float = 0.0
    found: Mapping[str, str] = field(default_factory=dict)
    stamp: int | None = None
    frame: str = ''
    each: bool = False
    parts: dict[Any, Any] = field(default_factory=dict)


# Looks into a message now and then, see `keep_counting`.
_look: Callable[[Publisher, Any, Sent], None] | None = None
# The open counters, who notes what is published, and the method that they have replaced.
_open: set[Traffic] = set()
_notes: list[Callable[[Publication, Any], None]] = []
_original: Callable[[Publisher, Any], None] = Publisher.publish

# `'publishes'` or `'hears'`, a node and a topic.
Way = tuple[str, str, str]


class Publication(NamedTuple):
    """A call of `publish()` in this process.

    Attributes:
        publisher: Whose method was called.
        began: When, in nanoseconds since 1970. The stamp of the message is not before that,
        ended: and not after this.
        caller: The node in whose callback that was, with the name of the callback; None outside.
    """

    publisher: Publisher
    began: int
    ended: int
    caller: tuple[str, str] | None = None


@contextmanager
def publications(
    tell: Callable[[Publication], None] = lambda publication: None,
) -> Iterator[list[Publication]]:
    """Note what is published in this process meanwhile: a message does not say who has sent it.

    Args:
        tell: Called with each of them at once.
    """
    notes: list[Publication] = []

    def note(publication: Publication, _: Any) -> None:
        notes.append(publication)
        tell(publication)

    note_each(note)
    try:
        yield notes
    finally:
        _notes.remove(note)
        _replace()


def note_each(note: Callable[[Publication, Any], None]) -> None:
    """Call `note` from now on with what is published in this process, after it was published."""
    _notes.append(note)
    _replace()


def _replace() -> None:
    """Replace `Publisher.publish` as long as somebody counts or notes its calls."""
    wanted = _publish if _open or _notes or _look is not None else _original
    Publisher.publish = wanted  # type: ignore[method-assign, assignment]


@functools.wraps(Publisher.publish)
def _publish(publisher: Publisher, msg: Any) -> None:
    began = time.time_ns()
    _original(publisher, msg)
    now = time.monotonic()
    try:
        sent = publisher._labkit_sent  # type: ignore[attr-defined]
    except AttributeError:
        sent = publisher._labkit_sent = Sent(first=now)  # type: ignore[attr-defined]
    sent.count += 1
    sent.last = now
    ended = time.time_ns()
    for note in tuple(_notes):
        note(Publication(publisher, began, ended, _caller()), msg)
    if _look is not None and (sent.each or sent.count == 1 or now - sent.looked_at >= LOOK_SEC):
        sent.looked_at = now
        _look(publisher, msg, sent)


def _caller() -> tuple[str, str] | None:
    found = runtime.executor.caller() if runtime.started else None
    return (found[0].name, found[1]) if found is not None else None


def keep_counting(look: Callable[[Publisher, Any, Sent], None]) -> None:
    """Count from now on in any case, and look into a message of each publisher now and then.

    Args:
        look: Called after a message was published, for the first one of a publisher, and from then
            on at most once in `LOOK_SEC`, or for each one once it has set `Sent.each`.
    """
    global _look
    _look = look
    _replace()


def sent_by(publisher: Publisher) -> Sent:
    """Return what a publisher has published while that was counted."""
    return getattr(publisher, '_labkit_sent', None) or Sent()


class Traffic:
    """Counts the messages that pass between nodes while it is open."""

    def __init__(self) -> None:
        # Against the page's thread and that of ROS. Never held during a wait.
        self._lock = threading.Lock()
        self._cell_runs = False
        # Publisher or subscription -> number of messages reported already.
        self._reported: WeakKeyDictionary[Any, int] = WeakKeyDictionary()
        self._node: Node | None = None
        self._heard: dict[str, Listener] = {}

    def open(self) -> None:
        """Start counting."""
        if self in _open:
            return
        _open.add(self)
        _replace()
        for event, function in self._at_cells():
            _events().register(event, function)
        self._reported.update({end: count for _, end, count in self._counts()})

    def close(self) -> None:
        """Stop counting."""
        self._forget_others()
        if self in _open:
            _open.remove(self)
            for event, function in self._at_cells():
                _events().unregister(event, function)
            _replace()

    def listen_to_others(self, topics: Iterable[GraphTopic]) -> None:
        """Subscribe to those of the current topics on which other processes publish."""
        wanted = {topic.name: kind for topic in topics if (kind := _type_to_hear(topic))}
        with self._lock:
            if self._cell_runs:
                return
            for name in self._heard.keys() - wanted.keys():
                self._drop(name)
            for name in wanted.keys() - self._heard.keys():
                self._subscribe(name, wanted[name])

    def passed(self, topics: Iterable[GraphTopic]) -> dict[Way, int]:
        """Return the number of messages on the current topics since the last call.

        A message from one of several publishers in other processes is counted for none of them:
        its sender is unknown.
        """
        topics = tuple(topics)
        names = {topic.name for topic in topics}
        new: Counter[Way] = Counter()
        for way, end, count in self._counts():
            if way[2] in names:
                new[way] += max(0, count - self._reported.get(end, 0))
                self._reported[end] = count
        for topic in topics:
            self._add_others(topic, new)
        return {way: count for way, count in new.items() if count}

    # -- in this process ------------------------------------------------------------------------

    def _counts(self) -> Iterator[tuple[Way, Any, int]]:
        """Yield each publisher and subscription of this process with its number of messages."""
        entries = {entry.node: entry for entry in runtime.nodes()}
        for node in existing_nodes():
            name = full_name(node)
            with suppress(InvalidHandle):  # destroyed meanwhile
                for publisher in list(node.publishers):
                    way = ('publishes', name, publisher.topic_name)
                    yield way, publisher, sent_by(publisher).count
                entry = entries.get(node)
                for subscription in list(node.subscriptions) if entry is not None else ():
                    assert entry is not None
                    way = ('hears', name, subscription.topic_name)
                    yield way, subscription, entry.counts.get(subscription, 0)

    # -- in other processes ---------------------------------------------------------------------

    def _at_cells(self) -> list[tuple[str, Callable[..., None]]]:
        """Return IPython's events with their callbacks."""
        if not settings.in_kernel():
            return []
        return [('pre_run_cell', self._on_cell_start), ('post_run_cell', self._on_cell_end)]

    def _on_cell_start(self, *_: object) -> None:
        self._cell_runs = True
        self._forget_others()

    def _on_cell_end(self, *_: object) -> None:
        self._cell_runs = False

    def _forget_others(self) -> None:
        """Destroy all subscriptions."""
        with self._lock:
            node, self._node = self._node, None
            self._heard.clear()
            if node is not None:
                # Not `destroy_node`, which calls other views: one might wait for this thread.
                node.destroy_node()  # type: ignore[no-untyped-call]

    def _subscribe(self, topic: str, kind: str) -> None:
        if self._node is None:
            assert runtime.helper is not None
            self._node = helper_node('_labkit_traffic', context=runtime.helper.context)
        # The type may not be installed, or the topic may have another one in this process.
        with suppress(LabError, compat.RCLError):
            self._heard[topic] = Listener(
                self._node,
                topic,
                message_class(kind),
                lambda data: None,
                qos_profile=least_profile(QUEUE),
                raw=True,
            )

    def _drop(self, topic: str) -> None:
        self._heard.pop(topic).close()

    def _add_others(self, topic: GraphTopic, new: Counter[Way]) -> None:
        """Add the messages that other processes have sent and received on a topic."""
        own = {end.node: _is_here(end) for end in (*topic.publishers, *topic.subscriptions)}
        sent = {node: new['publishes', node, topic.name] for node, here in own.items() if here}
        with self._lock:
            listener = self._heard.get(topic.name)
            heard = compat.take_all(listener.subscription, QUEUE) if listener is not None else 0
        # The listener hears messages of this process, too.
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
    return settings.shell().events


def _is_here(end: Endpoint) -> bool:
    """Return whether a publisher or subscription belongs to this process."""
    assert runtime.helper is not None
    return is_own(end.gid, runtime.helper)


def _type_to_hear(topic: GraphTopic) -> str:
    """Return the type of a topic on which other processes publish; '' if there are several."""
    kinds = {end.msg_type for end in (*topic.publishers, *topic.subscriptions)}
    foreign = any(not _is_here(end) for end in topic.publishers)
    return kinds.pop() if foreign and len(kinds) == 1 else ''
