"""Play a bag back, in the background: `play`.

The bytes of the messages are published as they are, with the QoS that their publishers had
offered, in a thread of its own that keeps the times in between.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from rclpy.time import Time
from rosgraph_msgs.msg import Clock

from labkit.background.compat import RCLError
from labkit.background.discovery import asking_node
from labkit.background.runtime import runtime
from labkit.background.session import Session, end_earlier
from labkit.bags.listeners import wait_for_listeners, wait_until_heard
from labkit.bags.offers import offered_profile
from labkit.bags.reader import Bag, BagMessage, BagTopic, open_bag
from labkit.errors import LabError, LabTimeout
from labkit.rosgraph.interfaces import message_class
from labkit.rosgraph.matching import other_type_here
from labkit.rosgraph.names import full_topic_name
from labkit.rosgraph.refusals import Refused

if TYPE_CHECKING:
    from rclpy.publisher import Publisher

__all__ = ['Playing', 'play']

NODE_NAME = 'rosbag2_player'
CLOCK = '/clock'
# How long subscriptions that are in the graph may take to be found, s.
MATCH_SEC = 2.0
# How long the last messages may take to be heard, s.
HEARD_SEC = 1.0
# Who was held up for longer goes on from there, with the same pauses, s.
LATE_SEC = 0.05
# A loop takes so long at least, s.
LOOP_SEC = 0.1
# rosgraph_msgs' own QoS for /clock is best effort, depth 1; publishers offer reliable.
_CLOCK_DEPTH = 1


class Playing(Session):
    """A bag that is played back in the background. Made by `play`; a context manager.

    Attributes:
        bag: What is played.
        rate: How many times as fast as it was.
        counts: How many messages were published, by the topic's name, as it is published.
        skipped: Topics that can not be played, with the reason.
        error: What has ended it early, None if nothing has.
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
    ) -> None:
        super().__init__(NODE_NAME)
        self.bag = bag
        self.rate = rate
        self.counts: dict[str, int] = {}
        self.skipped: dict[str, str] = {}
        self._loop, self._start_sec = loop, start_offset
        self._publishers: dict[tuple[str, str], tuple[str, Publisher]] = {}
        for topic in topics:
            self._advertise(topic, (remap or {}).get(topic.name, topic.name))
        self._clock = None if clock is None else _Ticks(self._node, clock)
        # What other threads ask for, and when the thread is to look at that.
        self._changed = threading.Condition()
        self._paused = paused
        self._wanted_sec: float | None = None
        # The time in the bag, s, at a moment of `time.monotonic()`.
        self._base_sec, self._base_at, self._moving = start_offset, 0.0, False
        self._go()

    @property
    def position_sec(self) -> float:
        """Return how far it is, s since the beginning of the bag."""
        if self._wanted_sec is not None:
            return self._wanted_sec
        moving = self._moving and not self._paused
        passed = (time.monotonic() - self._base_at) * self.rate if moving else 0.0
        return min(max(self._base_sec + passed, 0.0), self.bag.duration_sec)

    @property
    def paused(self) -> bool:
        """Tell whether it stands still."""
        return self._paused

    def pause(self) -> None:
        """Stand still until `resume()`."""
        with self._changed:
            if not self._paused:
                self._base_sec, self._paused = self.position_sec, True
                self._changed.notify_all()

    def resume(self) -> None:
        """Go on after `pause()`."""
        with self._changed:
            if self._paused:
                self._base_at, self._paused = time.monotonic(), False
                self._changed.notify_all()

    def seek(self, sec: float) -> None:
        """Go on from another place.

        Args:
            sec: Seconds since the beginning of the bag.
        """
        with self._changed:
            self._wanted_sec = min(max(float(sec), 0.0), self.bag.duration_sec)
            self._changed.notify_all()

    def stop(self) -> None:
        """End it."""
        with self._changed:
            self._stopping.set()
            self._changed.notify_all()
        super().stop()

    def wait(self, timeout_sec: float | None = None) -> None:
        """Wait until it has come to its end.

        Args:
            timeout_sec: Seconds to wait. Block forever if `None` or negative. Don't wait if 0.

        Raises:
            LabTimeout: It goes on.
            LabError: It has ended early.
        """
        if not runtime.wait(lambda: self.done, timeout_sec):
            state = 'It stands still: resume() lets it go on.' if self._paused else ''
            at = f'{self.position_sec:.1f} of {self.bag.duration_sec:.1f} s'
            raise LabTimeout(
                f'{str(self.bag.path)!r} has come to {at} in {timeout_sec:g} s.', todo=state
            )
        if self.error is not None:
            raise LabError(f'Playing {str(self.bag.path)!r} has ended early: {self.error}')

    def __repr__(self) -> str:
        state = 'Played' if self.done else 'Paused' if self._paused else 'Playing'
        at = f'{self.position_sec:.1f} of {self.bag.duration_sec:.1f} s'
        counts = ', '.join(f'{name} ({count})' for name, count in sorted(self.counts.items()))
        lines = [f'{state} {self.bag.path}: {at}' + (f': {counts}' if counts else '')]
        lines += [f'{name} is not played: {why}' for name, why in self.skipped.items()]
        return '\n'.join(lines)

    # -- before it begins -----------------------------------------------------------------------

    def _advertise(self, topic: BagTopic, name: str) -> None:
        """Make the publisher of a topic, or note why that can't be done."""
        try:
            msg_type = message_class(topic.msg_type)
        except Refused:
            self.skipped[topic.name] = f'its type {topic.msg_type} is not installed here'
            return
        if topic.serialization_format != 'cdr':
            self.skipped[topic.name] = f'its format {topic.serialization_format} is not cdr'
            return
        try:
            publisher = self._node.create_publisher(
                msg_type, name, offered_profile(topic.qos_profiles)
            )
        except (RCLError, LabError) as error:
            why = other_type_here(self._node, name, msg_type) or str(error)
            self.skipped[topic.name] = why
            return
        self._publishers[topic.name, topic.msg_type] = (name, publisher)
        self.counts[name] = 0

    # -- playing, in a thread of its own --------------------------------------------------------

    def _work(self) -> None:
        try:
            with self.bag:
                published = [publisher for _, publisher in self._publishers.values()]
                wait_for_listeners(self._node, published, MATCH_SEC, self._stopping.is_set)
                begin: float | None = self._start_sec
                while begin is not None and not self._stopping.is_set():
                    begin = self._play_from(begin)
                self._wait_until_heard()
        finally:
            self._base_sec, self._moving = self.position_sec, False

    def _play_from(self, sec: float) -> float | None:
        """Play from a place on; return where to go on from, None if the end has come."""
        with self._changed:
            self._base_sec, self._base_at, self._moving = sec, time.monotonic(), True
        count = sum(self.counts.values())
        for message in self._messages(sec):
            wanted = self._wait_until((message.stamp_ns - self.bag.start_ns) * 1e-9)
            if wanted is not None or self._stopping.is_set():
                return wanted
            self._publish(message)
        if self._wanted_sec is not None:
            return self._wait_until(sec)
        if self._loop and sum(self.counts.values()) > count:
            # A bag of a moment would be played without a break.
            self._stopping.wait(max(0.0, LOOP_SEC - time.monotonic() + self._base_at))
            return self._start_sec
        return None

    def _messages(self, sec: float) -> Iterator[BagMessage]:
        names = {name for name, _ in self._publishers}
        return self.bag.messages(names, start_sec=sec)

    def _wait_until(self, sec: float) -> float | None:
        """Wait for a time of the bag; return where to go instead, None if it has come."""
        while not self._stopping.is_set():
            with self._changed:
                if self._wanted_sec is not None:
                    wanted, self._wanted_sec = self._wanted_sec, None
                    self._base_sec, self._base_at = wanted, time.monotonic()
                    return wanted
                now = time.monotonic()
                passed = 0.0 if self._paused else (now - self._base_at) * self.rate
                left = (sec - self._base_sec - passed) / self.rate
                if left <= 0 and not self._paused:
                    if left < -LATE_SEC:
                        # What is late is not rushed through: queues of listeners would run over.
                        self._base_at -= left
                    break
                limit = None if self._paused else left
                if self._clock is not None:
                    limit = (
                        self._clock.left_sec if limit is None else min(limit, self._clock.left_sec)
                    )
                if limit is None or limit > 0:
                    self._changed.wait(limit)
            self._tick(sec)
        self._tick(sec)
        return None

    def _tick(self, next_sec: float) -> None:
        """Say the time, if it is time to: no later one than that of the next message.

        Who was held up goes on from that message. Time would go back then.
        """
        if self._clock is not None:
            sec = min(self.position_sec, next_sec)
            self._clock.publish(self.bag.start_ns + round(sec * 1e9))

    def _publish(self, message: BagMessage) -> None:
        name, publisher = self._publishers[message.topic, message.msg_type]
        publisher.publish(message.data)
        self.counts[name] += 1

    def _wait_until_heard(self) -> None:
        """Wait until what was published has come to others, and was heard in this process."""
        published = [publisher for _, publisher in self._publishers.values()]
        wait_until_heard(self._node, published, HEARD_SEC, self._stopping.is_set)
        if runtime.started and not self._stopping.is_set():
            runtime.executor.settle(HEARD_SEC)


class _Ticks:
    """A publisher on /clock that says the time of the bag at a steady rate."""

    def __init__(self, node: Any, rate_hz: float) -> None:
        self._publisher = node.create_publisher(Clock, CLOCK, _CLOCK_DEPTH)
        self._period_sec = 1.0 / rate_hz
        self._due = 0.0

    @property
    def left_sec(self) -> float:
        """Return how long it is to the next tick, s."""
        return max(0.0, self._due - time.monotonic())

    def publish(self, stamp_ns: int) -> None:
        """Say a time, ns, if it is time to."""
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
    """Play a bag back, in the background.

    It ends with the bag, with `stop()`, at the end of a `with` block, at `lab.stop()`, and when
    the cell is run again. The first message is published when those who subscribe already hear
    it.

    Args:
        path: The folder of the bag, or its one file.
        topics: A name, or several; all if None.
        rate: How many times as fast as it was.
        loop: Whether to begin again at the end, until it is stopped.
        remap: Name of a topic in the bag -> the name that it is published under.
        start_offset: Where to begin, s since the beginning of the bag.
        paused: Whether to wait for `resume()`.
        clock: How often to say the time of the bag on `/clock`, in Hz; None for never.
        wait: Whether to return only at the end.
        timeout_sec: How long to wait for the end at most, s; None for no end.

    Returns:
        The playing: its `pause()`, `resume()`, `seek(...)`, `wait()`, `stop()`.

    Raises:
        LabError: There is no such bag or topic, or an argument is not what it should be.
        LabTimeout: It was to be waited for, and goes on.
    """
    _check_positive('rate', rate)
    if clock is not None:
        _check_positive('clock', clock)
    if not isinstance(start_offset, (int, float)) or start_offset < 0:
        raise LabError(f'start_offset must be 0 or more, but it is {start_offset!r}.')
    node = asking_node()
    end_earlier(Playing)
    bag = open_bag(path)
    try:
        chosen = _choose(bag, topics, clock is not None)
        names = {
            bag.topic(old).name: full_topic_name(new, node) for old, new in (remap or {}).items()
        }
        playing = Playing(
            *(bag, chosen),
            rate=float(rate),
            loop=loop,
            remap=names,
            start_offset=start_offset,
            paused=paused,
            clock=clock,
        )
    except BaseException:
        bag.close()
        raise
    if wait:
        playing.wait(timeout_sec)
    return playing


def _choose(bag: Bag, topics: str | Iterable[str] | None, has_clock: bool) -> list[BagTopic]:
    if topics is None:
        names = {topic.name for topic in bag.topics}
    else:
        wanted = [topics] if isinstance(topics, str) else topics
        names = {bag.topic(name).name for name in wanted}
    if has_clock:
        names.discard(CLOCK)  # two clocks at once would go to and fro
    return [topic for topic in bag.topics if topic.name in names]


def _check_positive(name: str, value: object) -> None:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 < value < 1e9:
        raise LabError(f'{name} must be a number above 0, but it is {value!r}.')
