"""Record topics to a bag in the background: `record`.

Messages are never decoded. A subscription's callback only puts them into a queue; a thread writes
them in batches, and flushes several times a second so that they survive a crash.
"""

from __future__ import annotations

import os
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rclpy.parameter import Parameter

from labkit.asking.discovery import asking_node
from labkit.asking.listener import Listener
from labkit.asking.silence import why_silent
from labkit.background.compat import RCLError
from labkit.background.nodes import node_exists
from labkit.background.runtime import runtime
from labkit.background.session import Session, end_earlier, going_on
from labkit.bags.choice import TopicChoice, choose
from labkit.bags.metadata import profiles_to_text
from labkit.bags.schemas import ENCODING, full_definition
from labkit.bags.writer import BagWriter, Message, check_storage
from labkit.errors import LabError, LabTimeout, quoted
from labkit.rosgraph.endpoints import publishers
from labkit.rosgraph.interfaces import message_class
from labkit.rosgraph.matching import nobody_publishes, other_type_here
from labkit.rosgraph.names import full_topic_name

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.qos import QoSProfile

__all__ = ['Recording', 'record']

NODE_NAME = 'rosbag2_recorder'
# Period of looking for new topics, as in the real recorder.
DISCOVERY_SEC = 0.1
# Queue depth of subscriptions, for times when other callbacks keep the background busy.
DEPTH = 1000
# Memory limit for unwritten messages, as in the real recorder.
CACHE_BYTES = 100 << 20
# Memory overhead of a message.
_MESSAGE_BYTES = 250
# Messages older than this are on disk, whatever happens, s.
FLUSH_SEC = 0.5
_DRAIN_SEC = 0.03
_BATCH = 2000


class Recording(Session):
    """A recording in the background. Made by `record`; a context manager.

    Attributes:
        path: The folder of the bag.
        lost: Number of messages dropped because they came faster than they were written.
        skipped: Topics that can't be recorded, with the reason.
        warnings: Further remarks, as sentences.
        error: The error that ended it early, None if there was none.
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
        overrides: Mapping[str, QoSProfile] | None = None,
        use_sim_time: bool = False,
    ) -> None:
        super().__init__(NODE_NAME)
        self._overrides = overrides or {}
        # Stamps by /clock; messages before its first one are not recorded.
        self._clock = self._node.get_clock() if use_sim_time else None
        if use_sim_time:
            self._node.set_parameters([Parameter('use_sim_time', value=True)])  # type: ignore[no-untyped-call]
        self.path = writer.path
        self.lost = 0
        self.skipped: dict[str, str] = {}
        self.warnings: list[str] = []
        self._writer, self._choice = writer, choice
        self._writing = threading.Lock()
        self._queue: deque[Message] = deque()
        self._cache_bytes = cache_bytes
        self._received_bytes = self._written_bytes = 0
        self._left = -1 if count is None else count
        self._duration_sec = max_duration_sec
        self._accepting = True
        self._wake = threading.Event()
        self._counts: dict[str, int] = {}
        self._listeners: dict[str, Listener] = {}
        self.discover()
        if discovery:
            self._node.create_timer(DISCOVERY_SEC, self.discover)
        self._go()

    @property
    def counts(self) -> dict[str, int]:
        """Number of recorded messages by topic."""
        return dict(sorted(self._counts.items()))

    @property
    def count(self) -> int:
        """Number of recorded messages."""
        return sum(self._counts.values())

    @property
    def waiting(self) -> int:
        """Number of recorded messages still in memory."""
        return len(self._queue)

    def wait_for(
        self, count: int, topic: str | None = None, *, timeout_sec: float | None = 5.0
    ) -> None:
        """Wait until some number of messages has been recorded.

        Args:
            count: Number of messages since the start of the recording.
            topic: Topic to count; all if None.
            timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.

        Raises:
            LabTimeout: Fewer arrived. It says how many, and why if none did.
            LabError: The recording ended early.
        """
        name = full_topic_name(topic, self._node_for_names()) if topic is not None else None

        def recorded() -> int:
            return self.count if name is None else self._counts.get(name, 0)

        runtime.wait(lambda: recorded() >= count or self.done, timeout_sec)
        if recorded() >= count:
            return
        if self.error is not None:
            raise LabError(f'The recording of {quoted(str(self.path))} has ended: {self.error}')
        what = 'messages' if name is None else f'messages of {name}'
        raise LabTimeout(
            f'{recorded() or "None"} of {count} {what} came to {quoted(str(self.path))}.',
            todo=self._why_silent(name),
        )

    def stop(self) -> None:
        """Stop recording: write everything, and complete the bag."""
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

    def discover(self) -> None:
        """Subscribe to new topics. Called between callbacks."""
        if not self._accepting:
            return
        for name, types in self._choice.found(self._node):
            listener = self._listeners.get(name)
            if listener is not None:
                offered = [end.qos for end in publishers(self._node, name)]
                # Not to request more: messages would be lost in between.
                if not listener.hears_all(offered):
                    listener.follow(offered)
                    self._warn(name, listener)
            elif name not in self.skipped and (why := self._subscribe(name, types)):
                self.skipped[name] = why

    def _warn(self, name: str, listener: Listener) -> None:
        self.warnings += [f'{name}: {note}' for note in listener.notes]

    def _subscribe(self, name: str, types: list[str]) -> str:
        """Record a topic; return why that is impossible, '' if it is not."""
        if len(types) > 1:
            return f'it has more than one type: {", ".join(types)}'
        try:
            msg_type = message_class(types[0])
            definition = full_definition(types[0])
        except (LabError, OSError):
            return f'its type {types[0]} is not installed here'
        infos = self._node.get_publishers_info_by_topic(name)
        offered = [info.qos_profile for info in infos]
        with self._writing:
            number = self._writer.add_topic(
                name,
                types[0],
                qos=profiles_to_text(offered),
                definition=definition,
                encoding=ENCODING,
                type_hash=str(infos[0].topic_type_hash) if infos else '',
            )
        self._counts[name] = 0
        callback = self._make_callback(name, number)
        try:
            listener = Listener(
                self._node,
                name,
                msg_type,
                callback,
                offered=offered,
                qos_profile=self._overrides.get(name),
                depth=DEPTH,
                raw=True,
            )
        except (RCLError, LabError) as error:
            return other_type_here(self._node, name, msg_type) or str(error)
        self._listeners[name] = listener
        self._warn(name, listener)
        return ''

    def _make_callback(self, name: str, number: int) -> Callable[..., None]:
        """Return the callback of a subscription. It runs in the background and must be fast."""
        put, counts = self._queue.append, self._counts

        def record(data: bytes, info: dict[str, int]) -> None:
            if not self._accepting:
                return
            if self._received_bytes - self._written_bytes > self._cache_bytes:
                self.lost += 1
                return
            if self._clock is None:
                stamp = info['received_timestamp'] or time.time_ns()
            else:
                stamp = self._clock.now().nanoseconds
                if not stamp:
                    return
            put((number, stamp, info['source_timestamp'], data))
            self._received_bytes += len(data) + _MESSAGE_BYTES
            counts[name] += 1
            self._left -= 1
            if not self._left:
                self._accepting = False
                self._wake.set()

        return record

    # -- writing, in a thread -------------------------------------------------------------------

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
                f'{quoted(str(self.path))} can not be written: {error.strerror or error}. The '
                'recording has ended.',
                todo='What was written before can be read.',
            ) from error

    def _write_batch(self) -> None:
        queue = self._queue
        batch = [queue.popleft() for _ in range(min(len(queue), _BATCH))]
        if batch:
            with self._writing:
                self._writer.write(batch)
            self._written_bytes += sum(len(each[3]) + _MESSAGE_BYTES for each in batch)

    # -- messages -------------------------------------------------------------------------------

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
        listener = self._listeners[name]
        return why_silent(self._node, name, listener.msg_type, listener.profile)

    def _is_discovered(self) -> bool:
        """Return whether all existing publishers have discovered the recording."""
        return all(
            listener.subscription.get_publisher_count() >= len(publishers(self._node, name))
            for name, listener in self._listeners.items()
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
    """Record topics to a bag in the background.

    It ends with `stop()`, at the end of a `with` block, with `lab.stop()`, when the kernel is shut
    down, and when the cell is run again. As with `ros2 bag record`, topics that appear later are
    recorded too, and each message has its time of arrival.

    Args:
        path: Folder of the new bag.
        topics: One name or several. All that are not hidden if None.
        regex: Regular expression: topics with matching names.
        exclude: One or several: leave out topics with matching names.
        storage: `'mcap'` or `'sqlite3'`.
        max_duration_sec: Time limit, s.
        count: Limit on the number of messages.
        overwrite: Whether to replace an existing bag.
        timeout_sec: Seconds to wait for existing publishers to discover the recording. Block
            forever if `None` or negative. Don't wait if 0.

    Returns:
        The recording, with `counts`, `wait_for(...)` and `stop()`.

    Raises:
        LabError: The folder exists, or can't be written; or an argument is invalid.
    """
    check_storage(storage)
    if count is not None and (not isinstance(count, int) or count < 1):
        raise LabError(f'count must be a whole number of at least 1, but it is {quoted(count)}.')
    if max_duration_sec is not None and not max_duration_sec > 0:
        raise LabError(f'max_duration_sec must be above 0, but it is {quoted(max_duration_sec)}.')
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
    runtime.wait(lambda: recording.done or recording._is_discovered(), timeout_sec)
    return recording


def _refuse_twice(path: Path) -> None:
    for session in going_on(Recording):
        if session.path.resolve() == path.resolve():
            raise LabError(
                f'{quoted(str(path))} is being recorded just now.',
                todo='Choose another name, or end that recording first with its stop().',
            )


def start_recording(writer: BagWriter, choice: TopicChoice, **limits: Any) -> Recording:
    """Start a recording; close the bag if that fails."""
    try:
        return Recording(writer, choice, **limits)
    except BaseException:
        writer.abandon()
        raise
