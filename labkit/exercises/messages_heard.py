"""Real messages as data: what came on a topic, when it was sent, and as which one.

Messages are taken in the thread that asks, not by an executor. So they are seen even while a
callback of the learner's keeps the background thread busy.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from itertools import pairwise
from typing import Any, TypeVar

__all__ = ['Lived', 'Sample', 'Watch', 'build', 'streams_of']

DEPTH = 1000


@dataclass(frozen=True)
class Sample:
    """A message as it was received.

    Attributes:
        message: The message itself.
        stamp: When it was published, by the publisher's clock, in seconds.
        number: Its publisher's sequence number, from 1; 0 if that is not known.
    """

    message: Any
    stamp: float
    number: int


@dataclass(frozen=True)
class Lived(Sample):
    """A message that came while virtual time passed, see `life.Life`.

    Attributes:
        at: When it was published in virtual time, in seconds from its beginning.
        node: Full name of the node that has published it; empty if that is
            not known, as of another process.
    """

    at: float
    node: str = ''


AnySample = TypeVar('AnySample', bound=Sample)


class Watch:
    """The messages of a topic, from the moment it was made. Iterating gives the messages.

    Args:
        node: The node that subscribes; no executor needs to spin it.
        topic: Full name of the topic.
        msg_type: Name of its type, such as `'std_msgs/msg/Int16'`.
        reliable: Whether the publishers are reliable, so that it can ask for all messages.
        latched: Whether to ask for what was published before, too.
    """

    def __init__(
        self, node: Any, topic: str, msg_type: str, *, reliable: bool = True, latched: bool = False
    ) -> None:
        from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

        from labkit.asking.listener import Listener, least_profile
        from labkit.rosgraph.interfaces import message_class

        self.topic = topic
        self.msg_type = msg_type
        self.samples: list[Sample] = []
        self.last_arrival = self.started = time.monotonic()
        profile = least_profile(DEPTH)
        if reliable:
            profile.reliability = ReliabilityPolicy.RELIABLE
        if latched:
            profile.durability = DurabilityPolicy.TRANSIENT_LOCAL
        self._listener = Listener(
            node, topic, message_class(msg_type), lambda message: None, qos_profile=profile
        )

    def pump(self) -> None:
        """Take what has arrived."""
        handle, msg_class = self._listener.subscription.handle, self._listener.msg_type
        with handle:
            # No more than the queue holds: a flood may come faster than it is taken.
            for _ in range(DEPTH):
                taken = handle.take_message(msg_class, False)
                if taken is None:
                    break
                message, info = taken
                number = info.get('publication_sequence_number') or 0
                self.samples.append(Sample(message, info['source_timestamp'] * 1e-9, number))
                self.last_arrival = time.monotonic()

    def values(self, field: str) -> list[Any]:
        """Return one field of each message.

        Args:
            field: Name of the field; dots lead to inner ones, such as `'pose.position.x'`.
        """
        return [reduce(getattr, field.split('.'), sample.message) for sample in self.samples]

    def last_run(self) -> list[Sample]:
        """Return the messages of the publisher that was made last, where they come in turn.

        A cell or a command may have been run before; each publisher counts from 1.
        """
        run: list[Sample] = []
        for sample in self.samples:
            run = [*run, sample] if run and sample.number > run[-1].number else [sample]
        return run

    def streams(self) -> list[list[Sample]]:
        """Return the messages of each publisher, see `streams_of`."""
        return streams_of(self.samples)

    @property
    def intervals(self) -> list[float]:
        """The seconds from one message of a publisher to its next, by the publisher's clock."""
        return [
            later.stamp - earlier.stamp
            for stream in self.streams()
            for earlier, later in pairwise(stream)
        ]

    def clear(self) -> list[Sample]:
        """Forget what has come so far, and return it."""
        forgotten, self.samples = self.samples, []
        return forgotten

    def close(self) -> None:
        """Stop watching. What has come stays."""
        self._listener.close()

    def __len__(self) -> int:
        return len(self.samples)

    def __iter__(self) -> Iterator[Any]:
        return iter([sample.message for sample in self.samples])

    def __getitem__(self, index: int) -> Any:
        return self.samples[index].message


def streams_of(samples: Iterable[AnySample]) -> list[list[AnySample]]:
    """Return the messages of each publisher.

    A message does not say who sent it, but as which one: publishers that take turns, each
    counting its own messages, are told apart by that.
    """
    streams: list[list[AnySample]] = []
    for sample in samples:
        following = [s for s in streams if not sample.number or s[-1].number + 1 == sample.number]
        if following:
            # Of two that count alike, it is the turn of the one that has waited longer.
            min(following, key=lambda stream: stream[-1].stamp).append(sample)
        else:
            streams.append([sample])
    return streams


def build(msg_type: str, fields: Mapping[str, Any]) -> Any:
    """Return a message with some of its fields set.

    Args:
        msg_type: Name of the type.
        fields: Values by the name of the field; dots lead to inner ones: `{'linear.x': 0.1}`.
    """
    from labkit.rosgraph.interfaces import message_class

    message = message_class(msg_type)()
    for path, value in fields.items():
        *outer, last = path.split('.')
        setattr(reduce(getattr, outer, message), last, value)
    return message
