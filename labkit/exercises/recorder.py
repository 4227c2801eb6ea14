"""Remember what happens once: messages that are sent before a check is there to hear them."""

from __future__ import annotations

import contextlib
import itertools
import os
import time
from collections.abc import Iterable, Mapping
from typing import Any

from labkit.errors import LabError
from labkit.exercises.watch import Sample, Watch

__all__ = ['Recorder', 'Recording']

_numbers = itertools.count()
# How many messages of an earlier check are kept, at most.
MAX_KEPT = 100


class Recording(Watch):
    """What has come on a topic. It outlives a stop of ROS.

    Args:
        topic: Full name of the topic.
        msg_type: Name of its type.

    Attributes:
        samples: What has come since the last verdict.
        earlier: What the check before has kept of what came before it, see `keep`.
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
        """Hear what comes from now on; without effect if this node listens already.

        Raises:
            RuntimeError: In this process the topic has another type. LabError, likewise.
        """
        if self._node is not node:
            self._watch = Watch(node, self.topic, self.msg_type, reliable=False)
            self._node = node

    def pump(self) -> None:
        """Take what has arrived."""
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
        """Let the next check find these in `earlier`: they are no whole attempt yet."""
        self._kept = list(samples)[-MAX_KEPT:]

    def forget(self) -> None:
        """Forget what has come, but for what is to be kept."""
        self.samples.clear()
        self.earlier, self._kept = self._kept, []

    def close(self) -> None:
        """Stop listening. What has come stays."""
        if self._watch is not None:
            self._watch.close()


class Recorder:
    """A hidden node that listens to some topics for as long as the lesson is used.

    It is seen by publishers, as any subscription is. So only exercises that need it have it.

    Args:
        topics: Names of the topics, with their types.
    """

    def __init__(self, topics: Mapping[str, str]) -> None:
        self._recordings = {topic: Recording(topic, name) for topic, name in topics.items()}
        self._node: Any = None

    def keep(self) -> None:
        """Take what has come; start, or start again after `lab.stop()`, if ROS is up."""
        from labkit.background.runtime import runtime

        if not runtime.started:
            return
        from labkit.background.nodes import helper_node, node_exists

        if self._node is None or not node_exists(self._node):
            # Each has a name of its own: in a kernel a second node of a name replaces the first.
            self._node = helper_node(f'_recorder_{os.getpid()}_{next(_numbers)}')
        if self.keep not in runtime.after_start:
            # Whoever publishes when ROS is back may wait for a subscription.
            runtime.after_start.append(self.keep)
        for recording in self._recordings.values():
            # As long as a topic has another type in this process, ROS refuses this one.
            with contextlib.suppress(RuntimeError, LabError):  # RCLError has no public name
                recording.listen(self._node)
            recording.pump()

    def watches(self) -> dict[str, Recording]:
        """Return what has come on each topic so far."""
        self.keep()
        return self._recordings

    def forget(self) -> None:
        """Forget what has come, but for what is to be kept."""
        self.keep()
        for recording in self._recordings.values():
            recording.forget()
