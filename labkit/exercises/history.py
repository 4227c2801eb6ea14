"""What nodes of this process have published on the topics of a lesson, from its setup cell on.

A check sees what comes while it lets time pass. What came before is noted here: by whom, when and
what. That is done where `publish()` is called, so nobody subscribes for it, and the graph stays as
it is. What a node says after another cell was run is not held against it: the learner may have
tried something out with it. Lines of a log are noted, too, if a timer's callback has logged them.
"""

from __future__ import annotations

import importlib
import sys
import threading
import time
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from weakref import ReferenceType, WeakKeyDictionary, ref

from labkit import settings
from labkit.exercises.time.learner_time import learner_time

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.publisher import Publisher

    from labkit.asking.traffic import Publication

__all__ = ['History', 'Line', 'Note', 'history', 'made_at']

# So many messages of a topic are kept. If there were more, it is not known how they began.
MOST = 20_000


@dataclass(frozen=True)
class Note:
    """A message that was published.

    Attributes:
        owner: The node whose publisher it was; None if that is not known.
        began: When publishing it began, ns since 1970.
        ended: When it had been published, likewise.
        at: When it began in the learner's time, s.
        is_first: Whether no cell had been run since the one that has made the node.
        in_making: Whether the main thread has published it while its node had no executor.
        data: The message, serialized.
        msg_class: Its class.
    """

    owner: ReferenceType[Node] | None
    began: int
    ended: int
    at: float
    is_first: bool
    in_making: bool
    data: bytes
    msg_class: type[Any]

    def is_by(self, node: Node) -> bool:
        """Tell whether a node has published it."""
        return self.owner is not None and self.owner() is node

    @property
    def owner_age(self) -> float:
        """How long ago that node was made, s; 0 if that is not known."""
        node = self.owner() if self.owner is not None else None
        made = made_at(node) if node is not None else 0
        return 1e-9 * (self.began - made) if made else 0.0

    @property
    def message(self) -> Any:
        """The message."""
        from rclpy.serialization import deserialize_message

        return deserialize_message(self.data, self.msg_class)


@dataclass(frozen=True)
class Line:
    """A line that the callback of a timer has logged.

    Attributes:
        owner: The node of the timer.
        began: When it was logged, ns since 1970.
        logger: The name of the logger.
        text: The text.
        is_first: Whether no cell had been run since the one that has made the node.
    """

    owner: ReferenceType[Node]
    began: int
    logger: str
    text: str
    is_first: bool


class History:
    """What was published on some topics: a singleton, `history`."""

    def __init__(self) -> None:
        self._notes: dict[str, deque[Note]] = {}
        self._types: set[str] = set()
        self._lines: deque[Line] = deque(maxlen=MOST)
        self._owners: WeakKeyDictionary[Publisher, ReferenceType[Node]] = WeakKeyDictionary()
        self._begun = False

    def follow(self, names: Iterable[str]) -> None:
        """Note what is published on these topics, too, as soon as ROS has been started.

        Args:
            names: Full names of topics. The name of a type stands for all topics of that type.
        """
        for name in names:
            if name.startswith('/'):
                self._notes.setdefault(name, deque(maxlen=MOST))
            else:
                self._types.add(name)
        if self._begin not in settings.after_start:
            settings.after_start.append(self._begin)
        if 'labkit.background.runtime' in sys.modules:
            # A lesson is loaded without ROS, and may be once more when it runs.
            self._begin()

    def on(self, topic: str) -> list[Note] | None:
        """Return what was published on a topic; None if it is not known how that began."""
        notes = self._notes.get(topic)
        return list(notes) if notes is not None and len(notes) < MOST else None

    def lines_of(self, node: Node) -> list[Line]:
        """Return the lines that timers of a node have logged, at first and in the running cell."""
        from labkit.background.runtime import runtime

        since = runtime.console.cell_began
        return [
            line
            for line in tuple(self._lines)
            if line.owner() is node and (line.is_first or line.began >= since)
        ]

    def _begin(self) -> None:
        from labkit.asking.traffic import note_each
        from labkit.background.runtime import runtime

        if not self._begun:
            self._begun = True
            importlib.import_module('rclpy.serialization')  # or the first message waits for it
            note_each(self._note)
            runtime.console.on_log = self._note_line

    def _note_line(self, logger: str, text: str) -> None:
        from labkit.background.nodes import made
        from labkit.background.runtime import runtime

        caller = runtime.executor.caller() if runtime.started else None
        if caller is None or not runtime.executor.running_period():
            return
        node = caller[0].node
        origin = made.origins.get(node)
        is_first = origin is None or not origin.cell.ended
        self._lines.append(Line(ref(node), time.time_ns(), logger, text, is_first))

    def _note(self, publication: Publication, msg: Any) -> None:
        from rclpy.serialization import serialize_message

        from labkit.background.nodes import made
        from labkit.rosgraph.interfaces import type_name

        publisher = publication.publisher
        if isinstance(msg, bytes) or not (self._notes or self._types):
            return
        topic = publisher.topic_name
        if topic not in self._notes and type_name(type(msg)) in self._types:
            self._notes[topic] = deque(maxlen=MOST)
        notes = self._notes.get(topic)
        if notes is None:
            return
        owner = self._owner(publisher)
        node = owner() if owner is not None else None
        origin = made.origins.get(node) if node is not None else None
        notes.append(
            Note(
                owner,
                publication.began,
                publication.ended,
                learner_time.at(publication.began),
                origin is None or not origin.cell.ended,
                threading.current_thread() is threading.main_thread()
                and (node is None or node.executor is None),
                serialize_message(msg),
                type(msg),
            )
        )

    def _owner(self, publisher: Publisher) -> ReferenceType[Node] | None:
        from labkit.background.nodes import existing_nodes

        if publisher not in self._owners:
            for node in existing_nodes():
                if any(each is publisher for each in node.publishers):
                    self._owners[publisher] = ref(node)
        return self._owners.get(publisher)


history = History()


def made_at(node: Node) -> int:
    """Return when a node was made, ns since 1970; 0 if that is not known."""
    from labkit.background.nodes import made

    origin = made.origins.get(node)
    return origin.began if origin is not None else 0
