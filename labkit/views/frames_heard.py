"""The frames that are published, as tf2 hears them, and who publishes each.

A message does not say who has sent it, and rclpy does not tell. What nodes of this process send is
noted where they publish it; the rest comes from the others. If there are several of those, any of
them may have sent it.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from labkit.asking.traffic import sent_by
from labkit.background.nodes import existing_nodes, full_name, node_exists
from labkit.rosgraph.endpoints import publishers
from labkit.rosgraph.whose import is_own
from labkit.transforms.buffer_core import CACHE_TIME, BufferCore
from labkit.transforms.cache import NANOSECONDS
from labkit.transforms.transform_listener import AUTHORITY, QUEUE_DEPTH
from labkit.transforms.tree import Tree
from labkit.views.feed import Feed
from labkit.views.frames_tree import FrameChain, FrameEdge, FrameTree, grown
from labkit.views.graph_flow import Flow

if TYPE_CHECKING:
    from geometry_msgs.msg import TransformStamped
    from rclpy.node import Node

__all__ = ['HeardFrames']

MOVING, STATIC = '/tf', '/tf_static'
# Another parent that was heard no longer ago than this, s, or three intervals, is one more.
RECENT_SEC = 3.0
# So many refusals are kept.
MOST_REFUSED = 5
# Nothing new for this long, s: that is all there is.
QUIET_SEC = 1.0
# A stamp that is off by more than this, s, is of another clock, such as a simulator's.
ANOTHER_CLOCK_SEC = 3600.0

# Parent and child.
_Key = tuple[str, str]


@dataclass
class _Known:
    """What is known of an edge: how often it came, when last, and how old it was then, s."""

    is_static: bool
    count: int = 0
    heard_at: float = 0.0
    late: float = 0.0
    flow: Flow = field(default_factory=Flow)

    @property
    def topic(self) -> str:
        return STATIC if self.is_static else MOVING


class HeardFrames(BufferCore):
    """The frames that are heard while its feeds are open.

    Args:
        node: A node that asks the graph, and whose clock the age of transforms is measured by.

    Attributes:
        node: The same; another one after ROS was stopped.
        feeds: /tf and /tf_static, subscribed to as a listener of tf2 does.

    Raises:
        ImportError: The type of transforms can't be had here.
    """

    def __init__(self, node: Node) -> None:
        # Built when it is first asked for.
        from rclpy.qos import DurabilityPolicy, QoSProfile
        from tf2_msgs.msg import TFMessage

        super().__init__()
        self.node = node
        self._lock = threading.Lock()
        self._known: dict[_Key, _Known] = {}
        self._refused: dict[str, None] = {}
        self._new_at = time.monotonic()
        self._found = FrameTree()
        # Publishers that were there at the last look, and what own ones had sent at the beginning.
        self._ends: set[bytes] = set()
        self._before: dict[tuple[str, _Key], int] = {}
        latched = QoSProfile(depth=QUEUE_DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # type: ignore[no-untyped-call]
        latest = QoSProfile(depth=QUEUE_DEPTH)  # type: ignore[no-untyped-call]
        self.feeds = [
            Feed(MOVING, node, self._on_moving, msg_type=TFMessage, qos_profile=latest),
            Feed(STATIC, node, self._on_static, msg_type=TFMessage, qos_profile=latched),
        ]

    # -- hearing --------------------------------------------------------------------------------

    def _on_moving(self, message: Any) -> None:
        self._take(message.transforms, is_static=False)

    def _on_static(self, message: Any) -> None:
        self._take(message.transforms, is_static=True)

    def _take(self, transforms: Iterable[TransformStamped], *, is_static: bool) -> None:
        now, clock = time.monotonic(), self.node.get_clock().now().nanoseconds
        for one in transforms:
            self._set(one, AUTHORITY, is_static=is_static)
            key = _key(one.header.frame_id, one.child_frame_id)
            if not all(key) or key[0] == key[1]:
                continue
            stamp = one.header.stamp
            with self._lock:
                known = self._known.get(key)
                if known is None or known.is_static is not is_static:
                    known = self._known[key] = _Known(is_static)
                    self._new_at = now
                known.count += 1
                known.heard_at = now
                known.late = (clock - stamp.sec * NANOSECONDS - stamp.nanosec) / NANOSECONDS
                known.flow.add(now, 1)

    def _refuse(self, words: str) -> None:
        if len(self._refused) < MOST_REFUSED:
            self._refused[words] = None

    def _warn(self, words: str) -> None:
        """Say nothing: what is too old is not lost, newer ones have come."""

    # -- what there is --------------------------------------------------------------------------

    def follow_publishers(self) -> bool:
        """Return whether publishers have gone; then what was heard is forgotten, and heard anew.

        A static transform of one that has gone would stay for ever otherwise.
        """
        ends = {end.gid for topic in (MOVING, STATIC) for end in publishers(self.node, topic)}
        gone = self._ends - ends
        self._ends = ends
        if gone:
            self.forget()
        return bool(gone)

    def begin(self) -> None:
        """Count from now on: call it before the feeds are opened."""
        with self._lock:
            for known in self._known.values():
                known.count = 0
        self._new_at = time.monotonic()
        self._before = {key: sum(said.values()) for key, said in self._said_here().items()}

    def forget(self) -> None:
        """Forget all frames, and hear them anew."""
        open_feeds = [feed for feed in self.feeds if feed.is_open]
        for feed in open_feeds:
            feed.close()
        with self._lock:
            self._known.clear()
            self._refused.clear()
        self.tree = Tree(CACHE_TIME)
        self.begin()
        for feed in open_feeds:
            feed.open(self.node)

    def is_complete(self) -> bool:
        """Return whether all that is published was heard.

        That is known of what nodes of this process have sent. For the first message of those that
        have sent nothing yet, and for what others send, it waits until nothing new comes.
        """
        ends = [end for topic in (MOVING, STATIC) for end in publishers(self.node, topic)]
        foreign = any(not is_own(end.gid, self.node) for end in ends)
        mute = any(not sent_by(end).count for *_, end in self._publishers_here())
        with self._lock:
            known = {
                (STATIC if one.is_static else MOVING, key) for key, one in self._known.items()
            }
            quiet = time.monotonic() - self._new_at >= QUIET_SEC
        heard = set(self._said_here()) <= known
        return bool(ends) and (quiet or (bool(known) and heard and not foreign and not mute))

    def found(self) -> FrameTree:
        """Return the tree as it is, or as it was when ROS was stopped."""
        from rclpy.exceptions import InvalidHandle

        if node_exists(self.node):
            with suppress(InvalidHandle):  # stopped meanwhile
                self._found = self._look()
        return self._found

    def _look(self) -> FrameTree:
        said = self._said_here()
        foreign = {topic: self._foreign(topic) for topic in (MOVING, STATIC)}
        with self._lock:
            known = dict(self._known)
            refused = list(self._refused)
        edges = []
        for key, one in known.items():
            if self._is_superseded(key, one, known):
                continue
            topic = one.topic
            here, others = said.get((topic, key), {}), foreign[topic]
            names = list(here)
            count = sum(here.values()) - self._before.get((topic, key), 0)
            if not here or (not one.is_static and one.count > count + len(here)):
                names += others
            certain = len(others) < 2 or set(names) == set(here)
            edges.append(FrameEdge(*key, one.is_static, tuple(sorted(set(names))), certain))
        return grown(edges, self.why_apart, refused)

    def _is_superseded(self, key: _Key, one: _Known, known: dict[_Key, _Known]) -> bool:
        """Return whether a frame has another parent by now, and this one is not told any more."""
        now = time.monotonic()
        newer = any(
            other != key and other[1] == key[1] and known[other].heard_at > one.heard_at
            for other in known
        )
        if not newer:
            return False
        if one.is_static:
            topic = STATIC
            return not (self._said_here().get((topic, key)) or self._foreign(topic))
        return now - one.heard_at > max(RECENT_SEC, 3 / (one.flow.rate(now) or RECENT_SEC))

    def pace(self, parent: str, child: str) -> tuple[float, float] | None:
        """Return the rate of a moving frame, Hz, and how old its newest transform is, s.

        A stamp of another clock does not tell that: then it is the time since it was heard.
        """
        now = time.monotonic()
        with self._lock:
            known = self._known.get((parent, child))
            if known is None or known.is_static:
                return None
            since = now - known.heard_at
            late = known.late if abs(known.late) < ANOTHER_CLOCK_SEC else 0.0
            return known.flow.rate(now), since + late

    def why_apart(self, target: str, source: str) -> str:
        """Return why tf2 knows no way between two frames, '' if it does."""
        unknown = self.tree.why_unknown(target_frame=target, source_frame=source)
        return unknown or self.tree.why_not(target, source, 0)

    def chain(self, target: str, source: str) -> FrameChain:
        """Return the way between two frames.

        Args:
            target: The frame in which places are given; '' for the root of the tree.
            source: The frame whose place is asked for.

        Raises:
            TransformException: It is not known.
        """
        tree = self.found()
        above = {edge.child: edge for edge in tree.edges}
        if not target:
            target, met = source, {source}
            while target in above and above[target].parent not in met:
                target = above[target].parent
                met.add(target)
        frames = self.tree.chain(target, source)
        edges = tuple(edge for edge in tree.edges if {edge.parent, edge.child} <= set(frames))
        steps = {edge.child: self.tree.look(edge.parent, edge.child, 0)[1] for edge in edges}
        return FrameChain(target, source, self.tree.look(target, source, 0)[1], edges, steps)

    # -- whose they are -------------------------------------------------------------------------

    def _said_here(self) -> dict[tuple[str, _Key], dict[str, int]]:
        """Return who of this process has published what how often, by topic and edge."""
        found: dict[tuple[str, _Key], dict[str, int]] = {}
        for name, topic, publisher in self._publishers_here():
            for each in tuple(sent_by(publisher).parts.values()):
                by_name = found.setdefault((topic, _key(each.parent, each.child)), {})
                by_name[name] = by_name.get(name, 0) + each.count
        return found

    def _publishers_here(self) -> Iterator[tuple[str, str, Any]]:
        """Yield the publishers of transforms in this process: node, topic, and the publisher."""
        from rclpy.exceptions import InvalidHandle

        for node in existing_nodes():
            try:
                ends = [(full_name(node), end.topic_name, end) for end in node.publishers]
            except InvalidHandle:
                continue  # destroyed meanwhile
            yield from (end for end in ends if end[1] in (MOVING, STATIC))

    def _foreign(self, topic: str) -> list[str]:
        """Return the nodes whose messages are not noted here: those of other processes.

        Where nothing is noted, as in a script, it may be any.
        """
        ends = publishers(self.node, topic)
        others = {end.node for end in ends if not is_own(end.gid, self.node)}
        if not others:
            silent = {name for name, _, end in self._publishers_here() if not sent_by(end).count}
            others = {end.node for end in ends} & silent
        return sorted(others)


def _key(parent: str, child: str) -> _Key:
    return parent.removeprefix('/'), child.removeprefix('/')
