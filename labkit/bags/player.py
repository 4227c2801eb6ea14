"""Play a bag back in the background: `play`.

Messages are published as recorded bytes, with the QoS that their publishers offered, by a thread
that keeps the original timing.
"""

from __future__ import annotations

import copy
import os
import threading
import time
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from rclpy.qos import HistoryPolicy, QoSProfile
from rclpy.time import Time
from rosgraph_msgs.msg import Clock

from labkit.asking.delivery import wait_until_found, wait_until_taken
from labkit.asking.discovery import asking_node
from labkit.background.compat import RCLError
from labkit.background.runtime import runtime
from labkit.background.session import Session, end_earlier, going_on
from labkit.bags.reader import Bag, BagMessage, BagTopic, open_bag
from labkit.bags.recorder import Recording
from labkit.errors import LabError, LabTimeout, printable, quoted
from labkit.rosgraph.interfaces import message_class
from labkit.rosgraph.matching import other_type_here
from labkit.rosgraph.names import full_topic_name
from labkit.rosgraph.refusals import Refused

if TYPE_CHECKING:
    from rclpy.publisher import Publisher

__all__ = ['Playing', 'offered_profile', 'play', 'start_playing']

NODE_NAME = 'rosbag2_player'
CLOCK = '/clock'
# Time for the last messages to be received, s.
RECEIVE_SEC = 1.0
# After a longer delay, playing continues from there with the original pauses, s.
MAX_DELAY_SEC = 0.05
# Least duration of a loop, s.
LOOP_SEC = 0.1
# The usual QoS of /clock subscriptions is best effort, depth 1; publishers offer reliable.
_CLOCK_DEPTH = 1
DEFAULT_DEPTH = 10


class Playing(Session):
    """A bag that is being played in the background. Made by `play`; a context manager.

    Attributes:
        rate: Playback speed, as a multiple of real time.
        counts: Number of published messages, by the topic name under which they are published.
        skipped: Topics that can't be played, with the reason.
        error: The error that ended it early, None if there was none.
    """

    def __init__(
        self,
        bag: Bag,
        topics: list[BagTopic],
        *,
        rate: float = 1.0,
        loop: bool = False,
        remap: Mapping[str, str] | None = None,
        start_offset: float = 0.0,
        paused: bool = False,
        clock: float | None = None,
        end_sec: float | None = None,
        overrides: Mapping[str, QoSProfile] | None = None,
    ) -> None:
        super().__init__(NODE_NAME)
        self.bag = bag
        self.rate = rate
        self.counts: dict[str, int] = {}
        self.skipped: dict[str, str] = {}
        self._loop, self._start_sec, self._end_sec = loop, start_offset, end_sec
        self._overrides = overrides or {}
        self._publishers: dict[tuple[str, str], tuple[str, Publisher]] = {}
        for topic in topics:
            self._advertise(topic, (remap or {}).get(topic.name, topic.name))
        self._clock = None if clock is None else _ClockPublisher(self._node, clock)
        # Requests of other threads, and a signal to look at them.
        self._changed = threading.Condition()
        self._paused = paused
        self._steps = 0
        self._seek_sec: float | None = None
        # Time in the bag, s, at a time of `time.monotonic()`.
        self._base_sec, self._base_at, self._moving = start_offset, 0.0, False
        self._go()

    @property
    def position_sec(self) -> float:
        """Current position, s since the beginning of the bag."""
        if self._seek_sec is not None:
            return self._seek_sec
        moving = self._moving and not self._paused
        passed = (time.monotonic() - self._base_at) * self.rate if moving else 0.0
        return min(max(self._base_sec + passed, 0.0), self.bag.duration_sec)

    @property
    def paused(self) -> bool:
        """Whether it is paused."""
        return self._paused

    def pause(self) -> None:
        """Pause until `resume()`."""
        with self._changed:
            if not self._paused:
                self._base_sec, self._paused = self.position_sec, True
                self._changed.notify_all()

    def resume(self) -> None:
        """Continue after `pause()`."""
        with self._changed:
            if self._paused:
                self._base_at, self._paused, self._steps = time.monotonic(), False, 0
                self._changed.notify_all()

    def play_next(self) -> None:
        """Publish the next message, and stay paused; without effect while it plays."""
        with self._changed:
            if self._paused:
                self._steps += 1
                self._changed.notify_all()

    def set_rate(self, rate: float) -> None:
        """Change the playback speed.

        Args:
            rate: As a multiple of real time; more than 0.
        """
        _check_positive('rate', rate)
        with self._changed:
            self._base_sec, self._base_at = self.position_sec, time.monotonic()
            self.rate = float(rate)
            self._changed.notify_all()

    def seek(self, sec: float) -> None:
        """Continue from another position.

        Args:
            sec: Seconds since the beginning of the bag.
        """
        with self._changed:
            self._seek_sec = min(max(float(sec), 0.0), self.bag.duration_sec)
            self._changed.notify_all()

    def stop(self) -> None:
        """Stop playing."""
        with self._changed:
            self._stopping.set()
            self._changed.notify_all()
        super().stop()

    def wait(self, timeout_sec: float | None = None) -> None:
        """Wait for the end of the bag.

        Args:
            timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.

        Raises:
            LabTimeout: It is still playing.
            LabError: It ended early.
        """
        if not runtime.wait(lambda: self.done, timeout_sec):
            state = 'It stands still: resume() lets it go on.' if self._paused else ''
            at = f'{self.position_sec:.1f} of {self.bag.duration_sec:.1f} s'
            raise LabTimeout(
                f'{quoted(str(self.bag.path))} has come to {at} in {timeout_sec:g} s.', todo=state
            )
        if self.error is not None:
            raise LabError(f'Playing {quoted(str(self.bag.path))} has ended early: {self.error}')

    def __repr__(self) -> str:
        state = 'Played' if self.done else 'Paused' if self._paused else 'Playing'
        at = f'{self.position_sec:.1f} of {self.bag.duration_sec:.1f} s'
        counts = ', '.join(f'{name} ({count})' for name, count in sorted(self.counts.items()))
        lines = [f'{state} {self.bag.path}: {at}' + (f': {counts}' if counts else '')]
        lines += [f'{printable(name)} is not played: {why}' for name, why in self.skipped.items()]
        return '\n'.join(lines)

    # -- preparation ----------------------------------------------------------------------------

    def _advertise(self, topic: BagTopic, name: str) -> None:
        """Create the publisher of a topic, or note why that is impossible."""
        try:
            name = full_topic_name(name, self._node)
            msg_type = message_class(topic.msg_type)
        except Refused:
            self.skipped[topic.name] = f'its type {topic.msg_type} is not installed here'
            return
        except LabError as error:
            self.skipped[topic.name] = error.message.rstrip('.')
            return
        if topic.serialization_format != 'cdr':
            self.skipped[topic.name] = f'its format {topic.serialization_format} is not cdr'
            return
        try:
            publisher = self._node.create_publisher(
                msg_type,
                name,
                self._overrides.get(topic.name) or offered_profile(topic.qos_profiles),
            )
        except (RCLError, LabError) as error:
            why = other_type_here(self._node, name, msg_type) or str(error)
            self.skipped[topic.name] = why
            return
        self._publishers[topic.name, topic.msg_type] = (name, publisher)
        self.counts[name] = 0

    # -- playing, in a thread -------------------------------------------------------------------

    def _work(self) -> None:
        try:
            with self.bag:
                with runtime.executor.between_callbacks():
                    for recording in going_on(Recording):
                        recording.discover()
                published = [publisher for _, publisher in self._publishers.values()]
                wait_until_found(self._node, published, ended=self._stopping.is_set)
                begin: float | None = self._start_sec
                while begin is not None and not self._stopping.is_set():
                    begin = self._play_from(begin)
                self._wait_until_received()
        finally:
            self._base_sec, self._moving = self.position_sec, False

    def _play_from(self, sec: float) -> float | None:
        """Play from a position; return where to continue, None at the end."""
        with self._changed:
            self._base_sec, self._base_at, self._moving = sec, time.monotonic(), True
        count = sum(self.counts.values())
        for message in self._messages(sec):
            target = self._wait_until((message.stamp_ns - self.bag.start_ns) * 1e-9)
            if target is not None or self._stopping.is_set():
                return target
            self._publish(message)
        if self._seek_sec is not None:
            return self._wait_until(sec)
        if self._loop and sum(self.counts.values()) > count:
            # A bag of zero duration would loop without a pause.
            self._stopping.wait(max(0.0, LOOP_SEC - time.monotonic() + self._base_at))
            return self._start_sec
        return None

    def _messages(self, sec: float) -> Iterator[BagMessage]:
        names = {name for name, _ in self._publishers}
        return self.bag.messages(names, start_sec=sec, end_sec=self._end_sec)

    def _wait_until(self, sec: float) -> float | None:
        """Wait for a time of the bag; return another position requested meanwhile, or None."""
        while not self._stopping.is_set():
            with self._changed:
                if self._seek_sec is not None:
                    target, self._seek_sec = self._seek_sec, None
                    self._base_sec, self._base_at = target, time.monotonic()
                    return target
                if self._steps and self._paused:
                    self._steps -= 1
                    self._base_sec = sec
                    break
                now = time.monotonic()
                passed = 0.0 if self._paused else (now - self._base_at) * self.rate
                left = (sec - self._base_sec - passed) / self.rate
                if left <= 0 and not self._paused:
                    if left < -MAX_DELAY_SEC:
                        # Do not rush through delayed messages: subscribers' queues would overflow.
                        self._base_at -= left
                    break
                limit = None if self._paused else left
                if self._clock is not None:
                    limit = (
                        self._clock.left_sec if limit is None else min(limit, self._clock.left_sec)
                    )
                if limit is None or limit > 0:
                    self._changed.wait(limit)
            self._publish_clock(sec)
        self._publish_clock(sec)
        return None

    def _publish_clock(self, next_sec: float) -> None:
        """Publish /clock if it is due, but never later than the next message.

        After a delay, playing continues from that message, and the clock would go back.
        """
        if self._clock is not None:
            sec = min(self.position_sec, next_sec)
            self._clock.publish(self.bag.start_ns + round(sec * 1e9))

    def _publish(self, message: BagMessage) -> None:
        name, publisher = self._publishers[message.topic, message.msg_type]
        publisher.publish(message.data)
        self.counts[name] += 1

    def _wait_until_received(self) -> None:
        """Wait until published messages have reached others, and callbacks in this process."""
        published = [publisher for _, publisher in self._publishers.values()]
        wait_until_taken(self._node, published, RECEIVE_SEC, ended=self._stopping.is_set)
        if runtime.started and not self._stopping.is_set():
            runtime.executor.settle(RECEIVE_SEC)


class _ClockPublisher:
    """A publisher of /clock with the time of the bag at a steady rate."""

    def __init__(self, node: Any, rate_hz: float) -> None:
        self._publisher = node.create_publisher(Clock, CLOCK, _CLOCK_DEPTH)
        self._period_sec = 1.0 / rate_hz
        self._due = 0.0

    @property
    def left_sec(self) -> float:
        """Time to the next tick, s."""
        return max(0.0, self._due - time.monotonic())

    def publish(self, stamp_ns: int) -> None:
        """Publish a time, ns, if it is due."""
        now = time.monotonic()
        if now < self._due:
            return
        self._due = max(self._due + self._period_sec, now)
        self._publisher.publish(Clock(clock=Time(nanoseconds=stamp_ns).to_msg()))


def play(
    path: str | os.PathLike[str],
    topics: str | Iterable[str] | None = None,
    *,
    rate: float = 1.0,
    loop: bool = False,
    remap: Mapping[str, str] | None = None,
    start_offset: float = 0.0,
    paused: bool = False,
    clock: float | None = None,
    wait: bool = False,
    timeout_sec: float | None = None,
) -> Playing:
    """Play a bag back in the background.

    It ends with the bag, with `stop()`, at the end of a `with` block, with `lab.stop()`, and when
    the cell is run again. The first message is published once existing subscribers can receive it.

    Args:
        path: Folder of the bag, or its single file.
        topics: One name or several; all if None.
        rate: Playback speed, as a multiple of real time.
        loop: Whether to start over at the end, until it is stopped.
        remap: Name of a topic in the bag -> name to publish it under.
        start_offset: Start position, s since the beginning of the bag.
        paused: Whether to start paused.
        clock: Rate of `/clock` with the time of the bag, Hz; None for no `/clock`.
        wait: Whether to return only at the end.
        timeout_sec: Longest wait for the end, s; None for no limit.

    Returns:
        The playback, with `pause()`, `resume()`, `seek(...)`, `wait()` and `stop()`.

    Raises:
        LabError: There is no such bag or topic, or an argument is invalid.
        LabTimeout: `wait` was requested, and it is still playing.
    """
    playing = start_playing(
        path,
        topics,
        rate=rate,
        loop=loop,
        remap=remap,
        start_offset=start_offset,
        paused=paused,
        clock=clock,
    )
    if wait:
        playing.wait(timeout_sec)
    return playing


def start_playing(
    path: str | os.PathLike[str],
    topics: str | Iterable[str] | None = None,
    *,
    rate: float,
    start_offset: float,
    clock: float | None,
    remap: Mapping[str, str] | None,
    **more: Any,
) -> Playing:
    """Start playing. Arguments as for `play` and `Playing`."""
    _check_positive('rate', rate)
    if clock is not None:
        _check_positive('clock', clock)
    if not isinstance(start_offset, (int, float)) or start_offset < 0:
        raise LabError(f'start_offset must be 0 or more, but it is {quoted(start_offset)}.')
    node = asking_node()
    end_earlier(Playing)
    bag = open_bag(path)
    try:
        chosen = _choose(bag, topics, clock is not None)
        names = {
            bag.topic(old).name: full_topic_name(new, node) for old, new in (remap or {}).items()
        }
        return Playing(
            *(bag, chosen),
            rate=float(rate),
            remap=names,
            start_offset=start_offset,
            clock=clock,
            **more,
        )
    except BaseException:
        bag.close()
        raise


def offered_profile(recorded: list[QoSProfile]) -> QoSProfile:
    """Return the profile to publish with, as the real player does.

    If the publishers differed, or are unknown, it is the default profile.
    """
    if not recorded or any(_policies(profile) != _policies(recorded[0]) for profile in recorded):
        return QoSProfile(depth=DEFAULT_DEPTH)  # type: ignore[no-untyped-call]
    profile = copy.copy(recorded[0])
    # Recorded profiles lack history and depth, which the graph does not know.
    if profile.history != HistoryPolicy.KEEP_ALL:
        profile.history = HistoryPolicy.KEEP_LAST
        profile.depth = profile.depth or DEFAULT_DEPTH
    return profile


def _policies(profile: QoSProfile) -> tuple[object, ...]:
    """Return the policies that decide whether a publisher and a subscription match."""
    times = (profile.deadline, profile.liveliness_lease_duration)
    policies = (profile.reliability, profile.durability, profile.liveliness)
    return (*policies, *(duration.nanoseconds for duration in times))


def _choose(bag: Bag, topics: str | Iterable[str] | None, has_clock: bool) -> list[BagTopic]:
    if topics is None:
        names = {topic.name for topic in bag.topics}
    else:
        target = [topics] if isinstance(topics, str) else topics
        names = {bag.topic(name).name for name in target}
    if has_clock:
        names.discard(CLOCK)  # two clocks would make time jump back and forth
    return [topic for topic in bag.topics if topic.name in names]


def _check_positive(name: str, value: object) -> None:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 < value < 1e9:
        raise LabError(f'{name} must be a number above 0, but it is {quoted(value)}.')
