"""Record messages that are sent once, before a check can receive them."""

from __future__ import annotations

import contextlib
import itertools
import os
import time
from collections.abc import Iterable, Mapping
from typing import Any

from labkit import settings
from labkit.errors import LabError
from labkit.exercises.messages_heard import Sample, Watch

__all__ = ['Recorder', 'Recording']

_numbers = itertools.count()
# Most messages to keep from an earlier check.
MAX_KEPT = 100


class Recording(Watch):
    """The messages on a topic, which survive a stop of ROS.

    Attributes:
        samples: Messages since the last verdict.
        earlier: Messages that the previous check has kept, see `keep`.
    """

    def __init__(self, topic: str, msg_type: str) -> None:
        self.topic = topic
        self.msg_type = msg_type
        self.samples: list[Sample] = []
        self.earlier: list[Sample] = []
        self.last_arrival = self.started = time.monotonic()
        self._kept: list[Sample] = []
        self._node: Any = None
        self._watch: Watch | None = None

    def listen(self, node: Any) -> None:
        """Subscribe, unless this node has already.

        Raises:
            RuntimeError, LabError: The topic has another type in this process.
        """
        if self._node is not node:
            self._watch = Watch(node, self.topic, self.msg_type, reliable=False)
            self._node = node

    def pump(self) -> None:
        """Take the messages that have arrived."""
        from rclpy.exceptions import InvalidHandle

        if self._watch is None:
            return
        with contextlib.suppress(InvalidHandle):  # ROS was stopped
            self._watch.pump()
        if self._watch.samples:
            self.samples += self._watch.samples
            self._watch.samples.clear()
            self.last_arrival = self._watch.last_arrival

    def keep(self, samples: Iterable[Sample]) -> None:
        """Keep messages of an incomplete attempt for the next check, in `earlier`."""
        self._kept = list(samples)[-MAX_KEPT:]

    def forget(self) -> None:
        """Forget all messages except those to keep."""
        self.samples.clear()
        self.earlier, self._kept = self._kept, []

    def close(self) -> None:
        """Unsubscribe. The messages stay."""
        if self._watch is not None:
            self._watch.close()


class Recorder:
    """A hidden node that listens to some topics while the lesson is used.

    Publishers see its subscriptions, so only exercises that need it have one.

    Args:
        topics: Names of the topics, with their types.
    """

    def __init__(self, topics: Mapping[str, str]) -> None:
        self._recordings = {topic: Recording(topic, name) for topic, name in topics.items()}
        self._node: Any = None

    def keep(self) -> None:
        """Take the messages; subscribe first, also after a `lab.stop()`, if ROS is up."""
        from labkit.background.runtime import runtime

        if not runtime.started:
            return
        from labkit.background.nodes import helper_node, node_exists

        if self._node is None or not node_exists(self._node):
            # With a unique name: in a kernel a second node of a name replaces the first.
            self._node = helper_node(f'_recorder_{os.getpid()}_{next(_numbers)}')
        if self.keep not in settings.after_start:
            # The learner's publisher may wait for a subscription.
            settings.after_start.append(self.keep)
        for recording in self._recordings.values():
            # ROS refuses while the topic has another type in this process.
            with contextlib.suppress(RuntimeError, LabError):  # RCLError has no public name
                recording.listen(self._node)
            recording.pump()

    def watches(self) -> dict[str, Recording]:
        """Return the recording of each topic."""
        self.keep()
        return self._recordings

    def forget(self) -> None:
        """Forget all messages except those to keep."""
        self.keep()
        for recording in self._recordings.values():
            recording.forget()
