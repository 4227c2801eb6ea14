"""Record topics to a bag, in the background: `record`.

Messages are taken as they came over the network and never decoded. The callback of a subscription
does no more than to put one into a queue; a thread of its own writes what is there, many at a
time, and several times a second so that it can be read whatever happens.
"""

from __future__ import annotations

import os
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile

from labkit.background.compat import RCLError
from labkit.background.discovery import asking_node
from labkit.background.nodes import node_exists
from labkit.background.runtime import runtime
from labkit.background.session import Session, end_earlier, going_on
from labkit.bags.choice import TopicChoice, choose
from labkit.bags.metadata import profiles_to_text
from labkit.bags.schemas import ENCODING, full_definition
from labkit.bags.writer import BagWriter, Message, check_storage
from labkit.errors import LabError, LabTimeout
from labkit.rosgraph.endpoints import publishers
from labkit.rosgraph.interfaces import message_class
from labkit.rosgraph.matching import nobody_publishes, other_type_here, qos_mismatch
from labkit.rosgraph.names import full_topic_name
from labkit.rosgraph.qos import match_all

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.subscription import Subscription

__all__ = ['Recording', 'record']

NODE_NAME = 'rosbag2_recorder'
# How often it looks for new topics; that of the real recorder.
LOOK_SEC = 0.1
# How many messages a topic may be behind, as long as other callbacks keep the background busy.
DEPTH = 1000
# What waits to be written may take so much memory; that of the real recorder.
CACHE_BYTES = 100 << 20
# What a small message takes in memory besides its bytes.
_MESSAGE_BYTES = 250
# What was received so long ago can be read from the file, whatever happens.
FLUSH_SEC = 0.5
_DRAIN_SEC = 0.03
_BATCH = 2000


class Recording(Session):
    """A recording that goes on in the background. Made by `record`; a context manager.

    Attributes:
        path: The folder of the bag.
        lost: How many messages came but were not written, because the disk was too slow.
        skipped: Topics that can not be recorded, with the reason.
        warnings: What there is to know besides, as sentences.
        error: What has ended it early, None if nothing has.
    """

    def __init__(
        self,
        writer: BagWriter,
        choice: TopicChoice,
        *,
        count: int | None = None,
        max_duration_sec: float | None = None,
        cache_bytes: int = CACHE_BYTES,
        discovery: bool = True,
    ) -> None:
        super().__init__(NODE_NAME)
        self.path = writer.path
        self.lost = 0
        self.skipped: dict[str, str] = {}
        self.warnings: list[str] = []
        self._writer, self._choice = writer, choice
        self._writing = threading.Lock()
        self._queue: deque[Message] = deque()
        self._cache_bytes = cache_bytes
        self._came_bytes = self._written_bytes = 0
        self._left = -1 if count is None else count
        self._duration_sec = max_duration_sec
        self._accepting = True
        self._wake = threading.Event()
        self._counts: dict[str, int] = {}
        self._subscriptions: dict[str, Subscription] = {}
        self._numbers: dict[str, int] = {}
        self._look()
        if discovery:
            self._node.create_timer(LOOK_SEC, self._look)
        self._go()

    @property
    def counts(self) -> dict[str, int]:
        """Return how many messages of each topic were recorded, by the topic's name."""
        return dict(sorted(self._counts.items()))

    @property
    def count(self) -> int:
        """Return how many messages were recorded."""
        return sum(self._counts.values())

    @property
    def waiting(self) -> int:
        """Return how many of these wait in memory to be written."""
        return len(self._queue)

    def wait_for(
        self, count: int, topic: str | None = None, *, timeout_sec: float | None = 5.0
    ) -> None:
        """Wait until so many messages were recorded.

        Args:
            count: How many, since the recording began.
            topic: Of this topic; of all if None.
            timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.

        Raises:
            LabTimeout: Fewer came. It says how many, and why if none did.
            LabError: The recording has ended early.
        """
        name = full_topic_name(topic, self._node_for_names()) if topic is not None else None

        def recorded() -> int:
            return self.count if name is None else self._counts.get(name, 0)

        runtime.wait(lambda: recorded() >= count or self.done, timeout_sec)
        if recorded() >= count:
            return
        if self.error is not None:
            raise LabError(f'The recording of {str(self.path)!r} has ended: {self.error}')
        what = 'messages' if name is None else f'messages of {name}'
        raise LabTimeout(
            f'{recorded() or "None"} of {count} {what} came to {str(self.path)!r}.',
            todo=self._why_silent(name),
        )

    def stop(self) -> None:
        """End the recording: what has come is written, and the bag is whole."""
        self._accepting = False
        self._wake.set()
        super().stop()

    def __repr__(self) -> str:
        state = 'Recorded' if self.done else 'Recording'
        counts = ', '.join(f'{name} ({count})' for name, count in self.counts.items())
        parts = [f'{state} {self.path}: {self.count} messages' + (f': {counts}' if counts else '')]
        parts += [f'{self.lost} lost'] * bool(self.lost)
        parts += [f'{name} is not recorded: {why}' for name, why in self.skipped.items()]
        parts += [str(self.error)] * (self.error is not None)
        return '\n'.join(parts)

    # -- taking messages ------------------------------------------------------------------------

    def _look(self) -> None:
        """Subscribe to what has appeared since the last look."""
        if not self._accepting:
            return
        for name, types in self._choice.found(self._node):
            if name not in self.skipped and not (name in self._subscriptions and self._fits(name)):
                why = self._subscribe(name, types)
                if why:
                    self.skipped[name] = why

    def _fits(self, name: str) -> bool:
        """Tell whether a subscription hears all publishers; if not it is given up."""
        subscription = self._subscriptions[name]
        found = publishers(self._node, name)
        if not any(qos_mismatch(end.qos, subscription.qos_profile) for end in found):
            return True
        self._node.destroy_subscription(subscription)
        return False

    def _subscribe(self, name: str, types: list[str]) -> str:
        """Record a topic; return why that can't be done, '' if it can."""
        if len(types) > 1:
            return f'it has more than one type: {", ".join(types)}'
        try:
            msg_type = message_class(types[0])
            definition = full_definition(types[0])
        except (LabError, OSError):
            return f'its type {types[0]} is not installed here'
        infos = self._node.get_publishers_info_by_topic(name)
        profile = QoSProfile(depth=DEPTH)  # type: ignore[no-untyped-call]
        if infos:
            for warning in match_all(profile, [info.qos_profile for info in infos]):
                self.warnings.append(f'{name}: {warning}')
        if name not in self._numbers:
            with self._writing:
                self._numbers[name] = self._writer.add_topic(
                    name,
                    types[0],
                    qos=profiles_to_text([info.qos_profile for info in infos]),
                    definition=definition,
                    encoding=ENCODING,
                    type_hash=str(infos[0].topic_type_hash) if infos else '',
                )
            self._counts[name] = 0
        try:
            self._subscriptions[name] = self._node.create_subscription(
                msg_type,
                name,
                self._taker(name, self._numbers[name]),
                profile,
                # Each event costs a tenth of a message's way.
                event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
                raw=True,
            )
        except (RCLError, LabError) as error:
            return other_type_here(self._node, name, msg_type) or str(error)
        return ''

    def _taker(self, name: str, number: int) -> Callable[..., None]:
        """Return the callback of a subscription. It runs in the background, as short as can be."""
        put, counts = self._queue.append, self._counts

        def record(data: bytes, info: dict[str, int]) -> None:
            if not self._accepting:
                return
            if self._came_bytes - self._written_bytes > self._cache_bytes:
                self.lost += 1
                return
            stamp = info['received_timestamp'] or time.time_ns()
            put((number, stamp, info['source_timestamp'], data))
            self._came_bytes += len(data) + _MESSAGE_BYTES
            counts[name] += 1
            self._left -= 1
            if not self._left:
                self._accepting = False
                self._wake.set()

        return record

    # -- writing, in a thread of its own --------------------------------------------------------

    def _work(self) -> None:
        now = time.monotonic()
        end = float('inf') if self._duration_sec is None else now + self._duration_sec
        due = now + FLUSH_SEC
        try:
            while self._accepting or self._queue:
                self._write_batch()
                now = time.monotonic()
                if now >= due:
                    due = now + FLUSH_SEC
                    with self._writing:
                        self._writer.flush()
                if now >= end:
                    self._accepting = False
                if not self._queue:
                    self._wake.wait(min(_DRAIN_SEC, max(0.0, end - now)))
            with self._writing:
                self._writer.close()
        except OSError as error:
            self._accepting = False
            self._queue.clear()
            with self._writing:
                self._writer.abandon()
            raise LabError(
                f'{str(self.path)!r} can not be written: {error.strerror or error}. The '
                'recording has ended.',
                todo='What was written before can be read. Is the disk full?',
            ) from error

    def _write_batch(self) -> None:
        queue = self._queue
        batch = [queue.popleft() for _ in range(min(len(queue), _BATCH))]
        if batch:
            with self._writing:
                self._writer.write(batch)
            self._written_bytes += sum(len(each[3]) + _MESSAGE_BYTES for each in batch)

    # -- what to say ----------------------------------------------------------------------------

    def _node_for_names(self) -> Node:
        return self._node if node_exists(self._node) else asking_node()

    def _why_silent(self, name: str | None) -> str:
        if self.done:
            return 'The recording has ended.'
        if name is None:
            return '' if self._counts else 'None of the chosen topics is published.'
        if name in self.skipped:
            return f'It is not recorded: {self.skipped[name]}.'
        if not self._choice.takes(name, ''):
            return f'It is not among the chosen topics. Recorded: {", ".join(self._counts)}.'
        if name not in self._counts:
            return nobody_publishes(self._node, name)
        return 'Is the publisher running?'

    def _is_heard(self) -> bool:
        """Tell whether all publishers that are there know of the recording."""
        return all(
            subscription.get_publisher_count() >= len(publishers(self._node, name))
            for name, subscription in self._subscriptions.items()
        )


def record(
    path: str | os.PathLike[str],
    topics: str | Iterable[str] | None = None,
    *,
    regex: str | None = None,
    exclude: str | Iterable[str] | None = None,
    storage: str = 'mcap',
    max_duration_sec: float | None = None,
    count: int | None = None,
    overwrite: bool = False,
    timeout_sec: float | None = 5.0,
) -> Recording:
    """Record topics to a bag, in the background.

    It ends with `stop()`, at the end of a `with` block, at `lab.stop()`, when the kernel is shut
    down, and when the cell is run again. As with `ros2 bag record`, topics that appear later are
    recorded too, and each message has the time at which it came.

    Args:
        path: The folder of the bag. It is made.
        topics: A name, or several. All that are not hidden if None.
        regex: A regular expression: topics whose name contains it.
        exclude: One or several: not the topics whose name contains it.
        storage: `'mcap'` or `'sqlite3'`.
        max_duration_sec: It ends after so many seconds.
        count: It ends after so many messages.
        overwrite: Whether a bag of that name may be replaced.
        timeout_sec: Seconds to wait until what is published from now on is heard, where a
            publisher is there already. Block forever if `None` or negative. Don't wait if 0.

    Returns:
        The recording: its `counts`, `wait_for(...)`, `stop()`.

    Raises:
        LabError: The folder is there already, or can't be written; or an argument is not what it
            should be.
    """
    check_storage(storage)
    if count is not None and (not isinstance(count, int) or count < 1):
        raise LabError(f'count must be a whole number of at least 1, but it is {count!r}.')
    if max_duration_sec is not None and not max_duration_sec > 0:
        raise LabError(f'max_duration_sec must be above 0, but it is {max_duration_sec!r}.')
    node = asking_node()
    end_earlier(Recording)
    choice = choose(node, topics, regex, exclude)
    _refuse_twice(Path(path))
    recording = start_recording(
        BagWriter(Path(path), storage, overwrite=overwrite),
        choice,
        count=count,
        max_duration_sec=max_duration_sec,
    )
    runtime.wait(lambda: recording.done or recording._is_heard(), timeout_sec)
    return recording


def _refuse_twice(path: Path) -> None:
    for session in going_on(Recording):
        if session.path.resolve() == path.resolve():
            raise LabError(
                f'{str(path)!r} is being recorded just now.',
                todo='Choose another name, or end that recording first with its stop().',
            )


def start_recording(writer: BagWriter, choice: TopicChoice, **limits: Any) -> Recording:
    """Begin a recording; a bag that can't be recorded is closed.

    Args:
        writer: The bag.
        choice: Which topics.
        limits: As `Recording` takes them.
    """
    try:
        return Recording(writer, choice, **limits)
    except BaseException:
        writer.abandon()
        raise
